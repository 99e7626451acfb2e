# SPDX-License-Identifier: BSD-3-Clause
"""The board: every side on every scene, who answers otherwise with the number of times."""

import unittest

import pandas as pd
from small_records import PLOTS  # noqa: F401  puts plots/ on the path

from bvlab_plots import board


def rows():
    frame = pd.DataFrame([
        {"work": work, "polygons": 500, "method": method, "peer": peer, "volume": volume, "seed": seed, "frames": 10, "pairs": 360,
         "repetition": repetition, "later_ns": ns * 324 + repetition, "later_pairs": 324, "differing": wrong, "build_ns": 2e6,
         "p99_ns": 2 * ns * 36}
        for work in ("near", "slow") for method, peer, volume, ns, wrong in
        (("ours", "", "obb", 1000, 0), ("OPCODE", "opcode", "", 500, 36)) for seed in (1, 2) for repetition in range(3)])
    frame["variant"] = frame.method
    frame.attrs.update(name="small", settings=["work", "polygons", "method", "peer", "volume", "seed"])
    return frame


class Board(unittest.TestCase):
    def test_a_row_for_each_side_and_scene(self):
        table = board.board([rows()])
        self.assertEqual(list(table.scene.unique()), ["small, near", "small, slow"])
        self.assertEqual(len(table), 4)
        ours, theirs = table[table.side == "ours"].iloc[0], table[table.side == "OPCODE"].iloc[0]
        self.assertAlmostEqual(ours.us, 1, places=2)
        self.assertAlmostEqual(ours.times, 2, places=1)
        self.assertAlmostEqual(theirs.p99_us, 1, places=2)
        self.assertEqual((ours.wrong, theirs.wrong), (0, 100))
        self.assertEqual((ours.configuration, ours.chosen_by), ("obb", "we"))
        self.assertIn("manual", theirs.chosen_by)

    def test_each_folder_says_its_settings(self):
        said = board.settings_of_peers()
        for name in ("fcl-obb", "bullet", "ode", "opcode-coherent", "coal-obb", "embree", "cgal", "physx"):
            self.assertTrue(all(said[name]), name)

    def test_a_record_without_peers_has_no_rows(self):
        alone = rows()
        alone = alone[alone.peer == ""]
        alone.attrs = rows().attrs
        self.assertEqual(board.html_of([alone]), "")

    def test_the_page_has_buttons_to_sort_by(self):
        page = board.html_of([rows()])
        self.assertEqual(page.count("<tr>"), 5)
        self.assertIn('<button type="button">wrong of 1000</button>', page)


if __name__ == "__main__":
    unittest.main()
