# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of figures, computed by hand beside; and a record as a frame."""

import contextlib
import io
import json
import tempfile
import unittest

import pandas as pd
from small_records import committed, own_record

from bvlab_plots import kinds, records
from bvlab_plots.captions import note_of
from bvlab_plots.figures import Figure
from bvlab_plots.points import points_of
from bvlab_plots.refused import Refused


def with_peers(rows):
    """Two peers beside each cell: one three times, one half as fast, which is wrong at ten degrees."""
    cells = rows[(rows.volume == "sphere") & (rows.strategy == "recursive")]
    peers = []
    for name, factor in (("quick", 1 / 3), ("slow", 2)):
        theirs = cells.assign(peer=name, volume="", strategy="", leaf_size="", time_ns=cells.time_ns * factor)
        peers.append(theirs.assign(differing=((theirs.degrees == 10) & (name == "quick")).astype(int)))
    return pd.concat([rows.astype({"leaf_size": str}), *peers])


def axis(label, **sets):
    """An axis of strategies, for a definition: what each value, named as its strategy, sets beside that."""
    values = "".join(f'[[axis.value]]\nname = "{name}"\nstrategy = "{name}"\n{more}\n' for name, more in sets.items())
    return f'\n[[axis]]\nname = "{label}"\n{values}'


class Points(unittest.TestCase):
    def points(self, change=None, more="", **keys):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as self.printed:
            record = own_record(folder, more, change)
            return points_of(records.read(record, clock="processor"), Figure(name="test", **keys))

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
        points = self.points(x="degrees", y="time_ns / pairs", series="strategy", pool="volume")
        # Boxes take twice as long as spheres: 100, 110, 120 and 200, 220, 240.
        self.assertAlmostEqual(self.at(points, 1, "recursive").middle, 160)
        self.assertEqual(points.attrs["pooled"], {"volume": 2, "repetition": 3})

    def test_an_axis_that_is_neither_named_nor_fixed_is_refused_by_name(self):
        with self.assertRaisesRegex(Refused, "'volume' is neither named nor fixed: 2 of its values"):
            self.points(x="degrees", y="time_ns / pairs", series="strategy")
        with self.assertRaisesRegex(Refused, "'strategy' is neither"):
            self.points(kind="map", x="degrees", y="volume", value="time_ns")
        for named in (dict(panels="volume"), dict(panel_rows="volume"), dict(where=["volume=obb"])):
            points = self.points(x="degrees", y="time_ns / pairs", series="strategy", **named)
            self.assertEqual(points.attrs["pooled"], {"repetition": 3})

    def test_over_a_variant_in_the_same_cell(self):
        points = self.points(x="degrees", y="time_ns", over="strategy=recursive", series="variant")
        for volume in ("sphere", "obb"):
            self.assertAlmostEqual(self.at(points, 10, f"{volume} recursive").middle, 1)
            # A quarter less, whatever the volume and the angle; spread as its own repetitions are.
            self.assertAlmostEqual(self.at(points, 10, f"{volume} deferred").middle, 0.75)
        self.assertAlmostEqual(self.at(points, 1, "obb deferred").low, 0.75 * 105 / 110)
        points = self.points(x="degrees", y="time_ns", over="volume=sphere, strategy=recursive", series="variant")
        self.assertAlmostEqual(self.at(points, 1, "obb deferred").middle, 1.5)

    def test_a_base_of_nothing(self):
        """What has nothing to be compared with is said to be so, and nothing else."""
        def none_at_one(rows):
            rows.loc[(rows.strategy == "recursive") & (rows.degrees == 1), "n_v"] = 0
            return rows
        points = self.points(none_at_one, x="degrees", y="n_v", over="strategy=recursive", series="variant")
        self.assertEqual(set(points.x), {0.1, 10})
        self.assertEqual(self.printed.getvalue().splitlines(), [
            "left out, over strategy=recursive, which is 0 in their cells: "
            "obb deferred, obb recursive, sphere deferred, sphere recursive"])
        with self.assertRaisesRegex(Refused, "over strategy=recursive: it is 0 in every cell"):
            self.points(lambda rows: rows.assign(n_v=rows.n_v.where(rows.strategy != "recursive", 0)), x="degrees",
                        y="n_v", over="strategy=recursive", series="variant")

    def test_points_of_unlike_many_values(self):
        """A base that lacks rows: some points have fewer values than others, which the caption says."""
        def lacking(rows):
            rows = pd.concat([rows.assign(seed=seed) for seed in range(8)])
            rows.insert(0, "seed", rows.pop("seed"))
            return rows[(rows.strategy != "recursive") | (rows.degrees != 1) | (rows.seed < 2)]
        keys = dict(x="degrees", y="n_v", series="variant")
        points = self.points(lacking, over="strategy=recursive", **keys)
        self.assertEqual(self.printed.getvalue(), "left out, in cells without strategy=recursive: obb deferred, sphere deferred\n")
        self.assertIn("Medians of 2 to 8 seeds × 3 repetitions", note_of(Figure(name="test", **keys), points))

    def test_names_that_are_one_number(self):
        """"1", "1.0", "01" and "True" are four readings, as in the table, and of no kind of number."""
        for names in (["1", "1.0", "01", "True"], ["1", "1.0", "01"], ["True", "False"], ["1", "TRUE"]):
            def named(rows, names=names):
                rows = pd.concat([rows.assign(reading=name) for name in names])
                rows.insert(0, "reading", rows.pop("reading"))
                return rows
            more = "\n[[axis]]\nname = \"reading\"\n" + "".join(f'[[axis.value]]\nname = "{name}"\n' for name in names)
            points = self.points(named, more, x="reading", y="time_ns", series="variant", where=["degrees=1"])
            self.assertEqual(list(dict.fromkeys(points.x)), names)
            self.assertEqual(points.attrs["pooled"], {"repetition": 3})
            alone = self.points(named, more, x="degrees", y="time_ns", series="variant", where=[f"reading={names[-1]}"])
            self.assertEqual(alone.attrs["pooled"], {"repetition": 3})

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

    def test_the_best_may_differ_in_all_that_the_axis_of_a_variant_sets(self):
        """An axis `method` sets the leaf size beside the strategy: the best is that of all methods."""
        methods = axis("method", recursive="leaf_size = 1", deferred="leaf_size = 4")
        points = self.points(lambda rows: rows.assign(method=rows.strategy, leaf_size=rows.strategy.map({"recursive": 1, "deferred": 4})),
                             methods, x="degrees", y="time_ns", over="best of ours", series="volume, method")
        self.assertAlmostEqual(self.at(points, 1, "sphere, recursive").middle, 1 / 0.75)
        self.assertAlmostEqual(self.at(points, 1, "sphere, deferred").middle, 1)
        self.assertAlmostEqual(self.at(points, 1, "obb, recursive").middle, 2 / 0.75)

    def test_a_condition_on_an_axis_that_sets_variants_does_not_narrow_the_best(self):
        """The axis may have any name: the best is that of all candidates, one of which is drawn."""
        points = self.points(lambda rows: rows.assign(candidate=rows.strategy), axis("candidate", recursive="", deferred=""),
                             x="degrees", y="time_ns", over="best of ours", series="volume", where=["candidate=recursive"])
        self.assertAlmostEqual(self.at(points, 1, "sphere").middle, 1 / 0.75)
        self.assertAlmostEqual(self.at(points, 1, "obb").middle, 2 / 0.75)

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
        self.assertAlmostEqual(row.ratio, 1.5, places=6)

    def test_bars_and_maps_say_the_same(self):
        """What the issue found: a map over recursive's drew 0.064 where bars drew 15.6."""
        keys = dict(over="strategy=recursive", where=["strategy=deferred", "volume=obb"])
        rows = dict(x="degrees", y="volume", value="time_ns", kind="map", **keys)
        drawn = {}
        for figure in (dict(x="degrees", y="time_ns", kind="bars", **keys), rows):
            with tempfile.TemporaryDirectory() as folder:
                record = records.read(own_record(folder))
                figure = Figure(name="test", **figure)
                drawing = kinds.drawing_of(figure, kinds.points_of(record, figure))
            drawn[figure.kind] = [text.get_text() for axis in drawing.axes for text in axis.texts]
            if figure.kind == "bars":
                self.assertEqual({round(patch.get_height(), 6) for patch in drawing.axes[0].patches}, {0.75})
        self.assertEqual(drawn["map"], ["0.75"] * 3)  # 1.33 were the inverse
        self.assertIn("over recursive's", drawing._suptitle.get_text().replace("\n", " "))

    def test_a_speedup_is_the_inverse_of_a_cost(self):
        points = self.points(x="degrees", y="time_ns", over="strategy=recursive", ratio="speedup", series="variant")
        self.assertAlmostEqual(self.at(points, 10, "obb deferred").middle, 1 / 0.75)

    def test_several_values_stand_beside_each_other(self):
        points = self.points(lambda rows: rows.assign(p99_ns=3 * rows.time_ns, worst_ns=5 * rows.time_ns), x="degrees",
                             y="time_ns, p99_ns, worst_ns", series="variant")
        self.assertEqual(len(points), 3 * 4 * 3)
        self.assertAlmostEqual(self.at(points, 1, "sphere recursive, worst frame's time").middle, 5500)
        with self.assertRaisesRegex(Refused, "same unit"):
            self.points(x="degrees", y="time_ns, n_v", series="variant")

    def test_statistics_and_intervals(self):
        keys = dict(x="degrees", y="time_ns / pairs", series="variant")
        for statistic, middle in (("mean", 110), ("worst", 120), ("least", 100), ("p99", 119.8)):
            row = self.at(self.points(statistic=statistic, **keys), 1, "sphere recursive")
            self.assertAlmostEqual(row.middle, middle)
        row = self.at(self.points(interval="range", **keys), 1, "sphere recursive")
        self.assertEqual((row.low, row.high), (100, 120))
        row = self.at(self.points(statistic="mean", **keys), 1, "sphere recursive")
        self.assertAlmostEqual(row.high - row.middle, 4.302652730 * 10 / 3**0.5)  # Student's t, two degrees of freedom
        row = self.at(self.points(interval="95%", **keys), 1, "sphere recursive")
        self.assertEqual((row.low, row.high), (100, 120))  # three are too few for more

    def test_over_another_record(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            other = own_record(folder, change=lambda rows: rows[rows.degrees != 10].assign(time_ns=2 * rows.time_ns))
            points = self.points(x="degrees", y="time_ns", series="variant", over=f"record={other}")
            self.assertEqual(set(points.x), {0.1, 1})
            self.assertTrue((abs(points.middle - 0.5) < 1e-9).all())
            self.assertEqual(len(points), 2 * 4)

    def test_times_are_processor_times(self):
        """What the issue found: wall times of 135, 362 and 169 us for processor times of 80, 90 and 85."""
        def disturbed(rows):
            longer = 1 + rows.repetition
            return rows.assign(time_ns=rows.time_ns * longer, wall_per_processor=longer, alone="no")

        points = self.points(disturbed, x="degrees", y="time_ns / pairs", series="variant")
        self.assertAlmostEqual(self.at(points, 1, "sphere recursive").middle, 110)
        self.assertIn("36 of 36 rows measured beside other work", note_of(Figure("a", "degrees"), points))
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            rows = records.read(own_record(folder, change=disturbed), clock="wall")
            figure = Figure("a", "degrees", y="time_ns / pairs", series="variant")
            points = points_of(rows, figure)
        self.assertAlmostEqual(self.at(points, 1, "sphere recursive").middle, 220)
        self.assertIn("Wall time", note_of(figure, points))

    def test_means_and_worst_frames_are_of_one_clock(self):
        """Of single frames only wall times are known: a mean of the processor's beside them was another clock's."""
        def disturbed(rows):
            longer = 1 + rows.repetition
            return rows.assign(time_ns=rows.time_ns * longer, worst_ns=7 * rows.time_ns, wall_per_processor=longer, alone="no")

        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            record = kinds.Rows(own_record(folder, change=disturbed))
            for y, clock, middle, said in (("time_ns, worst_ns", "", 220, "Wall time"), ("time_ns", "", 110, "Processor time"),
                                           ("worst_ns", "processor", 770, "(wall time: worst_ns)")):
                figure = Figure("a", "degrees", y=y, series="variant", clock=clock)
                points = points_of(record.of(figure), figure)
                drawn = points[(points.x == 1) & points.series.str.startswith("sphere recursive")].middle.iloc[0]
                self.assertAlmostEqual(drawn / 10 if drawn > 1000 else drawn, middle)
                self.assertIn(said, note_of(figure, points))

    def test_the_fastest_of_several_plays_is_said(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            rows = records.read(own_record(folder), clock="wall")
        figure = Figure("a", "degrees", y="time_ns / pairs", series="variant")
        self.assertNotIn("plays", note_of(figure, points_of(rows, figure)))
        rows.attrs["definition"]["parameters"] = {"plays": 5}
        self.assertIn("the fastest of 5 plays", note_of(figure, points_of(rows, figure)))

    def test_frames_timed_by_the_processor_s_clock_are_no_wall_times(self):
        machine = {"clock": "processor"}
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            path = own_record(folder, change=lambda rows: rows.assign(worst_ns=7 * rows.time_ns))
            for held, said in ((machine, "Processor time"), ({}, "Wall time"), (machine | {"later": [{"clock": "wall"}]}, "Wall time")):
                (path / "machine.json").write_text(json.dumps(held))
                record = kinds.Rows(path)
                figure = Figure("a", "degrees", y="time_ns, worst_ns", series="variant")
                self.assertIn(said, note_of(figure, points_of(record.of(figure), figure)))

    def test_where_wall_times_have_a_column_all_others_are_processor_times(self):
        for y, said in (("time_ns", "Processor time."), ("p99_ns", "Processor time."), ("wall_ns", "Wall time.")):
            points = self.points(lambda rows: rows.assign(wall_ns=2 * rows.time_ns, p99_ns=3 * rows.time_ns), x="degrees", y=y, series="variant")
            self.assertTrue(note_of(Figure("a", "degrees"), points).endswith(said), y)

    def test_a_note_stands_below_the_legend(self):
        """Whatever the resolution: of six lines it covered the last."""
        keys = dict(x="degrees", y="time_ns, p99_ns, worst_ns", series="strategy", where=["volume=obb"], width="column")
        points = self.points(lambda rows: rows.assign(p99_ns=3 * rows.time_ns, worst_ns=5 * rows.time_ns), **keys)
        drawing = kinds.drawing_of(Figure("a", **keys), points)
        for drawing.dpi in (72, 150, 200):
            drawing.draw_without_rendering()
            self.assertLessEqual(drawing.texts[-1].get_window_extent().y1, drawing.legends[0].get_window_extent().y0 + 0.03 * drawing.dpi)

    def test_a_figure_says_what_is_drawn(self):
        points = self.points(x="degrees", y="time_ns / pairs", series="strategy", pool="volume")
        self.assertEqual(note_of(Figure("a", "degrees"), points),
                         "Medians of 2 volume values × 3 repetitions; bars: quartiles. Wall time.")
        once = self.points(lambda rows: rows[rows.repetition == 0], x="degrees", y="n_v", series="variant")
        self.assertEqual(note_of(Figure("a", "degrees"), once), "Single runs, no interval.")

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

    def test_coherence(self):
        rows = records.read(committed("best-rebuilds"))
        self.assertTrue(rows.best_tests.notna().all())


if __name__ == "__main__":
    unittest.main()
