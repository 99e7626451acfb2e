# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of figures, computed by hand beside; and a record as a frame."""

import contextlib
import io
import tempfile
import unittest

import pandas as pd
from small_records import committed, own_record

import records
from figures import Figure
from points import points_of
from refused import Refused


def with_peers(rows):
    """Two peers beside each cell: one three times, one half as fast, which is wrong at ten degrees."""
    cells = rows[(rows.volume == "sphere") & (rows.strategy == "recursive")]
    peers = []
    for name, factor in (("quick", 1 / 3), ("slow", 2)):
        theirs = cells.assign(peer=name, volume="", strategy="", leaf_size="", time_ns=cells.time_ns * factor)
        peers.append(theirs.assign(differing=((theirs.degrees == 10) & (name == "quick")).astype(int)))
    return pd.concat([rows.astype({"leaf_size": str}), *peers])


class Points(unittest.TestCase):
    def points(self, change=None, **keys):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as self.printed:
            return points_of(records.read(own_record(folder, change=change)), Figure(name="test", **keys))

    def at(self, points, x, series):
        (row,) = points[(points.x == x) & (points.series == series)].itertuples()
        return row

    def test_medians_and_quartiles(self):
        row = self.at(self.points(x="degrees", y="time_ns / pairs", series="variant"), 1, "sphere recursive")
        # own_record: 1000 ns a degree and 100 more each repetition, of 10 pairs.
        self.assertAlmostEqual(row.middle, 110)
        self.assertAlmostEqual(row.low, 105)
        self.assertAlmostEqual(row.high, 115)

    def test_what_is_not_shown_goes_into_them(self):
        points = self.points(x="degrees", y="time_ns / pairs", series="strategy")
        # Boxes take twice as long as spheres: 100, 110, 120 and 200, 220, 240.
        self.assertAlmostEqual(self.at(points, 1, "recursive").middle, 160)

    def test_over_a_variant_in_the_same_cell(self):
        points = self.points(x="degrees", y="time_ns", over="strategy=recursive", series="variant")
        for volume in ("sphere", "obb"):
            self.assertAlmostEqual(self.at(points, 10, f"{volume} recursive").middle, 1)
            # A quarter less, whatever the volume and the angle; spread as its own repetitions are.
            self.assertAlmostEqual(self.at(points, 10, f"{volume} deferred").middle, 0.75)
        self.assertAlmostEqual(self.at(points, 1, "obb deferred").low, 0.75 * 105 / 110)
        points = self.points(x="degrees", y="time_ns", over="volume=sphere, strategy=recursive", series="variant")
        self.assertAlmostEqual(self.at(points, 1, "obb deferred").middle, 1.5)

    def test_conditions_on_what_it_is_over_do_not_hide_that(self):
        points = self.points(x="degrees", y="time_ns", over="strategy=recursive", series="strategy",
                             where=["strategy=deferred", "volume=obb"])
        self.assertEqual(set(points.series), {"deferred"})
        self.assertAlmostEqual(points.middle.iloc[0], 0.75)

    def test_over_the_best_peer_that_is_right(self):
        points = self.points(with_peers, x="degrees", y="time_ns", over="best peer", series="variant", where=["peer="])
        self.assertAlmostEqual(self.at(points, 1, "sphere recursive").middle, 3)
        self.assertAlmostEqual(self.at(points, 10, "sphere recursive").middle, 0.5)
        self.assertIn("quick", self.printed.getvalue())

    def test_over_the_best_of_ours(self):
        points = self.points(with_peers, x="degrees", y="time_ns", over="best of ours", series="peer", where=["peer!="])
        self.assertAlmostEqual(self.at(points, 1, "quick").middle, 1 / 3 / 0.75)
        self.assertAlmostEqual(self.at(points, 10, "slow").middle, 2 / 0.75)
        self.assertFalse(((points.x == 10) & (points.series == "quick")).any())

    def test_peers_whose_answers_differ_bear_a_mark_where_all_are_shown(self):
        points = self.points(with_peers, x="degrees", y="time_ns", series="variant", peers="all")
        self.assertTrue(self.at(points, 10, "quick").wrong)
        self.assertFalse(self.at(points, 10, "slow").wrong)

    def test_peers_stand_in_every_panel_of_what_they_do_not_have(self):
        points = self.points(with_peers, x="degrees", y="time_ns", series="variant", panels="volume")
        self.assertEqual(set(points[points.series == "slow"].panel), {"sphere", "obb"})

    def test_a_map_keeps_what_it_shows(self):
        points = self.points(kind="map", x="degrees", y="volume", value="time_ns", series="strategy",
                             over="volume=sphere, strategy=recursive")
        (row,) = points[(points.x == 1) & (points.y == "obb") & (points.series == "deferred")].itertuples()
        self.assertAlmostEqual(row.middle, 1650)
        self.assertAlmostEqual(row.ratio, 1 / 1.5, places=6)

    def test_times_beside_other_work_are_left_out(self):
        def beside(rows):
            return rows.assign(node="a", alone=(rows.repetition < 2).map({True: "yes", False: "no"}))

        points = self.points(beside, x="degrees", y="time_ns / pairs", series="variant")
        self.assertAlmostEqual(self.at(points, 1, "sphere recursive").middle, 105)  # 100 and 110, without 120
        self.assertIn("left out: times of 12 of 36 rows", self.printed.getvalue())
        counted = self.points(beside, x="degrees", y="n_v / pairs", series="variant")
        self.assertEqual(self.at(counted, 1, "obb recursive").middle, 20)

    def test_times_of_cells_in_which_none_was_alone_stay_and_are_named(self):
        points = self.points(lambda rows: rows.assign(alone="no"), x="degrees", y="time_ns / pairs", series="variant")
        self.assertAlmostEqual(self.at(points, 1, "sphere recursive").middle, 110)  # of 100, 110 and 120
        self.assertIn("beside other work: times of 36 of 36 rows", self.printed.getvalue())

    def test_records_of_counts_alone(self):
        def untimed(rows):
            return rows.assign(time_ns="", first_ns="", frames=10, node="a", alone="")

        points = self.points(untimed, x="degrees", series="variant")
        self.assertEqual(str(points.attrs["value"].text), "n_v / pairs")
        with self.assertRaisesRegex(Refused, "known for no row"):
            self.points(untimed, x="degrees", y="time_ns / pairs")

    def test_measured_against_measured(self):
        points = self.points(x="n_v / pairs", y="time_ns", series="strategy")
        self.assertEqual(len(points), 12)  # of every cell one


class Frames(unittest.TestCase):
    def test_types_units_and_order(self):
        rows = records.read(committed("hierarchies"))
        self.assertEqual(rows.attrs["units"]["time_ns"], "ns")
        self.assertEqual((rows.attrs["units"]["side"], rows.side.dtype), ("radii", float))
        self.assertEqual(list(dict.fromkeys(rows.strategy)), ["recursive", "recursive-both", "margins", ""])
        self.assertEqual(list(dict.fromkeys(rows.density)), ["interlocked", "dense", "sparse"])
        self.assertTrue((rows[rows.peer != ""].volume == "").all())
        closest = records.read(committed("closest-features"))
        self.assertTrue(closest[closest.peer == "fcl-gjk"].n_v.isna().all())
        self.assertIn("sphere margins", set(rows.variant))
        self.assertTrue({"work", "seed", "strategy"} <= set(rows.attrs["settings"]))
        self.assertFalse({"time_ns", "repetition"} & set(rows.attrs["settings"]))

    def test_other_libraries_are_peers_in_every_kind(self):
        for name, peers in (("boxes-fast", {"cgal-1000", "fcl-tree", "embree"}), ("stability-map", {"ode", "embree"}),
                            ("triangles-error", {"moller", "cgal"}), ("worlds", {"fcl-world", "bullet-world"})):
            rows = records.read(committed(name))
            self.assertLessEqual(peers, set(rows.peer))
            self.assertIn("", set(rows.peer))

    def test_coherence_and_frames(self):
        rows = records.read(committed("best-rebuilds"))
        self.assertTrue(rows.best_tests.notna().all())
        self.assertEqual(len(records.read(committed("nine-bunnies"), "frames")), 18000)


if __name__ == "__main__":
    unittest.main()
