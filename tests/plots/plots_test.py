# SPDX-License-Identifier: BSD-3-Clause
"""Every script of plots/ draws records in which a volume, a strategy, a peer and others have never been heard of:
nothing fails, nothing is missing in silence, and no stranger looks like its neighbour."""

import contextlib
import importlib
import io
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from small_records import PLOTS, names_added, small_record, stranger

import style

HELPERS = {"arguments", "records", "style"}
STRATEGIES = ["unheard-of strategy", "deferred:4", "deferred:8"]


def own(column):
    return [stranger(column)]


def winning(name, rows):
    """Each stranger is the fastest somewhere, since a map shows those alone."""
    if "time_ns" in rows:
        across = "degrees" if rows.degrees.nunique() > 1 else "polygons"
        fields = list(dict.fromkeys(zip(rows[across], rows["step" if across == "degrees" else "side"])))
        strangers = [("volume", stranger("volume")), ("peer", stranger("peer")),
                     *(("strategy", name) for name in STRATEGIES)]
        for (column, who), (a, b) in zip(strangers, fields):
            here = (rows[across] == a) & (rows["step" if across == "degrees" else "side"] == b)
            rows.loc[here & (rows[column] == who), "time_ns"] = 1000
    return rows


# Script: the record it draws, how much of it, and the strangers added, each like a name that is there.
SPECS = {
    "best_rebuilds": ("best-rebuilds", dict(motion=3), dict(volume="sphere", strategy=("deferred", STRATEGIES)),
                      dict(strategy="recursive")),
    "boxes_fast": ("boxes-fast", dict(set=2), dict(method=("blocks", [*own("method"), "grid", "brute-force"]),
                                                   set="random", motion="drift"), None),
    "boxes_precision": ("boxes-precision", dict(set=1, offset=3), dict(method="blocks", numbers="float, nearest",
                                                                       set="random"), None),
    "boxes_time": ("boxes-figure-4", dict(boxes=3), dict(method=("hybrid", [*own("method"), "grid", "brute-force"]),
                                                         set="adjacent"), None),
    "budget": ("budget", dict(budget=3), dict(volume="sphere", mesh="bunny"), None),
    "closest_features": ("closest-features", dict(motion=2, mesh=2),
                         dict(volume="rss", strategy=("recursive", STRATEGIES), mesh="icosphere:80"),
                         dict(strategy="recursive")),
    "coherence": ("coherence", dict(mesh=2, motion=2, manner=1),
                  dict(volume="obb", strategy=("deferred", STRATEGIES)), dict(strategy="recursive")),
    "cost_model": ("cost-model", dict(volume=3), dict(volume="sphere", strategy="deferred", density="dense"),
                   dict(strategy="recursive")),
    "distance_error": ("distance-error", dict(relative_error=3),
                       dict(volume="sphere", strategy="recursive", mesh="knot"), None),
    "fits": ("fits", dict(volume=2, build=["top-down-principal", "bottom-up"]),
             dict(volume="sphere", strategy="recursive", fit="tight"),
             dict(volume="sphere", fit="tight")),
    "hierarchies": ("hierarchies", dict(work=2, motion=1), dict(volume="sphere", strategy=("recursive", STRATEGIES),
                                                                density="dense"), dict(strategy="recursive")),
    "nine_bunnies": ("nine-bunnies", dict(seed=2, reading=2, frame=50),
                     dict(variant=("deferred", STRATEGIES), reading="one body, one freedom", density="dense"), None),
    "peers": ("peers", dict(size=1), dict(volume="sphere", strategy=("deferred", STRATEGIES), motion="all, 5 degrees",
                                          density="dense"), dict(strategy="recursive")),
    "posing": ("posing", dict(k=2), dict(policy="corners", query="contacts"), None),
    "stability_map": ("stability-map", dict(level=4), dict(volume="sphere", precision="float32", source="fcl-obb",
                                                           stressor="offset"), None),
    "tightness": ("tightness", dict(volume=2, mesh=2), dict(volume="sphere", fit="tight", mesh="bunny:500",
                                                            build="top-down-principal"), None),
    "triangles_error": ("triangles-error", dict(set=2), dict(test="moller", set="random"), None),
    "winner_maps": ("winners-motion", dict(volume=2), dict(volume="obb", strategy=("margins", STRATEGIES)),
                    dict(volume="obb", strategy="recursive"), winning),
    "worlds": ("worlds", dict(objects=1), dict(volume="obb", strategy=("deferred", STRATEGIES), room=(4, [7])),
               dict(strategy="recursive")),
}
# Drawn with others, without a name: the best of the peers, all strategies.
POOLED = {"cost_model": ["strategy"], "hierarchies": ["peer"]}
# Other records that the same script draws in another way.
ALSO = {
    "boxes_time, displacements": ("boxes-displacement", dict(set=1, displacement=4),
                                  dict(method="blocks", set="random"), None),
    "boxes_time, events": ("boxes-events", dict(set=1), dict(method="blocks", set="adjacent", motion="drift"), None),
    "coherence, workloads": ("workloads", {}, dict(volume="obb", strategy=("deferred", STRATEGIES)),
                             dict(strategy="recursive")),
    "winner_maps, scene": ("winners-scene", dict(volume=2), dict(volume="obb", strategy=("margins", STRATEGIES)),
                           dict(volume="obb", strategy="recursive"), winning),
}


def looks_drawn(axis):
    """Of each label of an axis: how its lines or bars look, the black ones of neither apart."""
    looks = {}
    for line in axis.get_lines():
        if not str(line.get_label()).startswith("_"):
            looks[line.get_label()] = (line.get_color(), line.get_marker(), line.get_linestyle(),
                                       str(line.get_markerfacecolor()))
    for bars in axis.containers:
        if hasattr(bars, "patches") and len(bars.patches):
            patch = bars.patches[0]
            looks[bars.get_label()] = (patch.get_facecolor(), patch.get_hatch())
    return looks


class Scripts(unittest.TestCase):
    def draw(self, script, folder, out):
        """Figures as they are when they are saved, and what was printed."""
        figures, save = [], style.save

        def saved(figure, *arguments):
            figures.append((" ".join(text.get_text() for text in figure.findobj(lambda a: hasattr(a, "get_text"))),
                            [looks_drawn(axis) for axis in figure.axes]))
            path = save(figure, *arguments)
            self.assertGreater(Path(path).stat().st_size, 1500, path)
            return path

        printed = io.StringIO()
        arguments = [f"{script}.py", str(folder), "--out", str(out)]
        with mock.patch.object(style, "save", saved), mock.patch.object(style, "DPI", 40), \
                mock.patch.object(sys, "argv", arguments), \
                contextlib.redirect_stdout(printed):
            importlib.import_module(script).main()
        self.assertTrue(figures, f"{script} draws nothing")
        return figures, printed.getvalue()

    def check(self, script, name, keep, strangers, peer_like, change=None):
        with tempfile.TemporaryDirectory() as folder:
            record = small_record(name, Path(folder) / "record", keep, strangers, peer_like, change)
            figures, printed = self.draw(script, record, Path(folder) / "figures")
        said = " ".join(line for line in printed.splitlines() if line.startswith("left out"))
        seen = said + " ".join(text for text, _ in figures)
        for name in names_added(strangers, peer_like):
            if name not in map(stranger, POOLED.get(script, [])):
                self.assertIn(str(name), seen, f"{script}: left out in silence")
        for _, axes in figures:
            for looks in axes:
                new = [label for label in looks if "unheard-of" in label or ":" in label]
                for label in new:
                    others = [look for other, look in looks.items() if other != label]
                    self.assertNotIn(looks[label], others, f"{script}: {label} looks like another")

    def test_every_script(self):
        scripts = {path.stem for path in PLOTS.glob("*.py")} - HELPERS
        self.assertEqual(scripts, set(SPECS), "a script that is not tested, or is no more")
        for script, spec in {**SPECS, **ALSO}.items():
            with self.subTest(script):
                self.check(script.partition(",")[0], *spec)


class Looks(unittest.TestCase):
    STRANGERS = ["capsule", "periodic:2", "periodic:4", "periodic:8", "deferred:2", "deferred:4", "a library"]

    def test_unlike_neighbours(self):
        volumes = ["sphere", "obb", "aabb", "kdop14", "kdop18", "kdop26", "rss", "shell"]
        found = style.looks(volumes + self.STRANGERS[:4])
        for name in self.STRANGERS[:4]:
            for other, look in found.items():
                if other != name:
                    self.assertEqual(style.likeness(found[name], [look])[0], 0, f"{name} is like {other}")

    def test_all_differ_where_there_are_more_than_markers(self):
        found = style.looks(f"volume {i}" for i in range(40))
        self.assertEqual(len({tuple(map(str, look.values())) for look in found.values()}), 40)

    def test_the_order_of_names_is_nothing(self):
        self.assertEqual(style.looks(self.STRANGERS), style.looks(reversed(self.STRANGERS)))

    def test_the_same_in_another_run_and_another_figure(self):
        program = "import style; print([style.looks([n])[n] for n in %r])" % self.STRANGERS
        for seed in ("1", "2"):
            run = subprocess.run([sys.executable, "-B", "-c", program], cwd=PLOTS, text=True, check=True,
                                 env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True)
            self.assertEqual(run.stdout.strip(), str([style.looks([n])[n] for n in self.STRANGERS]))
        self.assertEqual(style.looks(["sphere", "capsule"])["capsule"], style.looks(["capsule"])["capsule"])

    def test_each_parameter_has_its_own_look(self):
        found = style.looks(["deferred", "deferred:2", "deferred:4"])
        self.assertEqual(found["deferred"], style.STYLES["deferred"])
        self.assertEqual(len({str(look) for look in found.values()}), 3)

    def test_variants_differ_by_volume_and_by_strategy(self):
        found = style.variant_looks(["sphere deferred", "capsule deferred", "capsule periodic:8", "a-library"])
        drawn = {str(style.point_style(look)) for look in found.values()}
        self.assertEqual(len(drawn), 4)


if __name__ == "__main__":
    unittest.main()
