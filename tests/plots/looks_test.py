# SPDX-License-Identifier: BSD-3-Clause
"""Looks of names that nobody has heard of: stable, and unlike their neighbours'."""

import os
import subprocess
import sys
import unittest

from small_records import PLOTS

from bvlab_plots import looks, style, ticks

STRANGERS = ["capsule", "periodic:2", "periodic:4", "periodic:8", "deferred:2", "deferred:4", "a library"]


class Ticks(unittest.TestCase):
    def test_every_logarithmic_axis_has_two_numbers(self):
        for low, high in ((31, 43), (55.1, 61), (0.9, 1.1), (1, 1000), (1e-9, 1e9), (1.00001, 1.00002)):
            shown = ticks.log_ticks(low, high)
            self.assertTrue(2 <= len(shown) <= 7, (low, high, shown))
            self.assertTrue(all(low <= tick <= high for tick in shown), (low, high, shown))


class Looks(unittest.TestCase):
    def test_unlike_neighbours(self):
        volumes = ["sphere", "obb", "aabb", "kdop14", "kdop18", "kdop26", "rss", "shell"]
        found = looks.looks(volumes + STRANGERS[:4])
        for name in STRANGERS[:4]:
            for other, look in found.items():
                if other != name:
                    self.assertEqual(looks.likeness(found[name], [look])[0], 0, f"{name} is like {other}")

    def test_all_differ_where_there_are_more_than_markers(self):
        found = looks.looks(f"volume {i}" for i in range(40))
        self.assertEqual(len({tuple(map(str, look.values())) for look in found.values()}), 40)

    def test_the_order_of_names_is_nothing(self):
        self.assertEqual(looks.looks(STRANGERS), looks.looks(reversed(STRANGERS)))

    def test_the_same_in_another_run_and_another_figure(self):
        program = f"from bvlab_plots import looks; print([looks.looks([n])[n] for n in {STRANGERS}])"
        for seed in ("1", "2"):
            run = subprocess.run([sys.executable, "-B", "-c", program], cwd=PLOTS, text=True, check=True,
                                 env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True)
            self.assertEqual(run.stdout.strip(), str([looks.looks([n])[n] for n in STRANGERS]))
        self.assertEqual(looks.looks(["sphere", "capsule"])["capsule"], looks.looks(["capsule"])["capsule"])

    def test_each_parameter_has_its_own_look(self):
        found = looks.looks(["deferred", "deferred:2", "deferred:4"])
        self.assertEqual(found["deferred"], looks.STYLES["deferred"])
        self.assertEqual(len({str(look) for look in found.values()}), 3)

    def test_variants_differ_by_volume_and_by_strategy(self):
        for volumes in (["sphere", "capsule"], ["sphere", "capsule", "obb", "rss", "shell"]):
            keys = [(strategy, volume) for strategy in ("deferred", "periodic:8") for volume in volumes]
            found = looks.joint_looks([*keys, ("a-library", "")])
            for drawn in (style.point_style, style.bar_style):
                self.assertEqual(len({str(drawn(look)) for look in found.values()}) if drawn is style.point_style or
                                 len(volumes) < 4 else len(found), len(found))


if __name__ == "__main__":
    unittest.main()
