# SPDX-License-Identifier: BSD-3-Clause
"""Every kind of figure, of records made here: fits, terms, distributions and tables against numbers known beforehand;
and two records compared."""

import contextlib
import io
import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from drawing import PLOTS, Seen
from small_records import own_record

from bvlab_plots import compare, comparing, draw, figures, kinds, records, scatters, tables, unit_costs
from bvlab_plots.refused import Refused
from bvlab_plots.ticks import Scale, numeric_ticks

C_U, C_V, C_P = 12, 7, 41


def counting(rows):
    """Counts as drawn, and times as the model has it; of boxes everything is three times as dear."""
    random = np.random.default_rng(1)
    counts = {name: random.integers(10, 1000, len(rows)) * scale for name, scale in (("n_u", 1), ("n_v", 5), ("n_p", 2))}
    dear = rows.volume.map({"sphere": 1, "obb": 3})
    return rows.assign(**counts, time_ns=dear * (C_U * counts["n_u"] + C_V * counts["n_v"] + C_P * counts["n_p"]))


class Kinds(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def found(self, change=None, **keys):
        figure = figures.figure_from(dict(name="test", **keys))
        with contextlib.redirect_stdout(io.StringIO()):
            record = own_record(tempfile.mkdtemp(dir=self.folder), change=change)
            rows = kinds.Rows(record).of(figure)
            return figure, kinds.points_of(rows, figure)

    def drawn(self, *found):
        return kinds.drawing_of(*found)

    def texts(self, drawing):
        return " ".join(text.get_text() for text in drawing.findobj(lambda each: hasattr(each, "get_text"))).replace("\n", " ")

    def test_a_power_law_is_found(self):
        found = self.found(lambda rows: rows.assign(n_v=rows.time_ns**1.5), kind="scatter", x="time_ns", y="n_v",
                           fit="power", series="strategy")
        self.assertEqual(len(found[1]), 12)  # of every cell one
        self.assertIn("recursive: exponent 1.50 [1.50, 1.50], R² 1.00", self.texts(self.drawn(*found)))
        self.assertIn("a point for each cell", self.texts(self.drawn(*found)).lower())

    def test_the_interval_of_an_exponent_holds_the_truth(self):
        held, random = 0, np.random.default_rng(3)
        for _ in range(200):
            x = random.uniform(1, 100, 12)
            fit = scatters.Fit("power", x, 3 * x**0.8 * np.exp(random.normal(0, 0.2, 12)))
            held += fit.low <= 0.8 <= fit.high
        self.assertTrue(180 <= held <= 199, held)  # 95 %

    def test_a_line_is_found(self):
        fit = scatters.Fit("line", [1, 2, 3, 4], [5, 7, 9, 11])
        self.assertAlmostEqual(fit.slope, 2)
        self.assertAlmostEqual(fit.at(10), 23)
        with self.assertRaisesRegex(Refused, "three points"):
            scatters.Fit("line", [1, 2], [3, 4])

    def test_terms_are_what_time_is_made_of(self):
        figure, points = self.found(counting, kind="stacked", x="degrees, strategy", panels="volume", y="time_ns / pairs")
        for volume, dear in (("sphere", 1), ("obb", 3)):
            part = points[points.panel == volume]
            self.assertTrue((part[["posing_ns", "volumes_ns", "triangles_ns"]].to_numpy() > 0).all())
        with contextlib.redirect_stdout(io.StringIO()):
            rows = records.read(own_record(tempfile.mkdtemp(dir=self.folder), change=counting))
        costs, share = unit_costs.fitted(rows)
        np.testing.assert_allclose(costs["sphere"], [C_U, C_V, C_P], rtol=1e-9)
        np.testing.assert_allclose(costs["obb"], [3 * C_U, 3 * C_V, 3 * C_P], rtol=1e-9)
        self.assertAlmostEqual(share, 1)
        drawing = self.drawn(figure, points)
        for mention in ("measured", "N_u C_u", "unit costs fitted", "12 to 36"):
            self.assertIn(mention.lower(), self.texts(drawing).lower())
        with self.assertRaisesRegex(Refused, "has no n_u, n_p"):
            self.found(kind="stacked", x="degrees")

    def test_terms_that_cost_nothing_are_refused(self):
        def free(rows):
            rows = counting(rows)
            return rows.assign(time_ns=C_P * rows.n_p)

        with self.assertRaisesRegex(Refused, "unit costs of (sphere|obb): by the fit volume tests would be free"):
            self.found(free, kind="stacked", x="degrees, strategy", panels="volume", y="time_ns / pairs")

    def test_counts_stand_beside_times(self):
        found = self.found(counting, x="degrees", y="time_ns / pairs; n_v / pairs, n_p / pairs", series="strategy",
                           panels="volume", pool="degrees")
        drawing = self.drawn(*found)
        self.assertEqual([axis.get_title() for axis in drawing.axes], ["sphere", "obb", "", ""])
        labels = [axis.get_ylabel().replace("\n", " ") for axis in drawing.axes[::2]]
        self.assertEqual([labels[0].split(" (")[0], labels[1].strip()], ["time per pair", "value"])
        legend = [text.get_text() for text in drawing.legends[0].get_texts()]
        self.assertEqual(len(legend), 2 + 4)
        for kind in ("line", "bars"):
            drawing = self.drawn(*self.found(counting, kind=kind, x="strategy", y="time_ns / pairs; n_v / pairs", panels="volume",
                                             pool="degrees", y_label="time; tests"))
            self.assertIn("tests", drawing.axes[2].get_ylabel())
        with self.assertRaisesRegex(Refused, "panel_rows"):
            self.found(counting, x="degrees", y="time_ns; n_v", series="strategy", panel_rows="volume")

    def test_bars_on_a_logarithmic_axis_where_it_is_asked_for(self):
        keys = dict(kind="bars", x="degrees", y="time_ns", series="variant")
        self.assertFalse(self.drawn(*self.found(**keys)).axes[0].patches)
        drawing = self.drawn(*self.found(log="y", **keys))
        bars = drawing.axes[0].patches
        self.assertEqual(len(bars), 12)
        self.assertEqual({bar.get_y() for bar in bars}, {drawing.axes[0].get_ylim()[0]})
        self.assertIn("bars begin at", self.texts(drawing).lower())

    def test_a_logarithmic_axis_has_two_labels_at_least(self):
        for values in (np.linspace(20, 90, 12), np.linspace(2, 30, 12), np.geomspace(1e-3, 1e3, 12)):
            ticks, texts, log = numeric_ticks(values, Scale(values, True))
            self.assertTrue(log)
            self.assertGreater(len(set(texts)), 1)
            self.assertTrue(values.min() <= min(ticks) and max(ticks) <= values.max())

    def test_distributions(self):
        figure, points = self.found(kind="ecdf", x="time_ns / pairs", series="strategy", panels="volume", pool="degrees")
        curve = next(line for line in self.drawn(figure, points).axes[0].get_lines() if line.get_label() == "recursive")
        x, y = curve.get_data()
        # 100, 110, 120 a degree, of 0.1, 1 and 10 degrees: in the unit that reads.
        np.testing.assert_allclose(sorted(x[np.isfinite(x)] / x[-1]), np.array([10, 11, 12, 100, 110, 120, 1000, 1100, 1200])
                                   / 1200)
        self.assertAlmostEqual(y[-1], 1)
        with self.assertRaisesRegex(Refused, "'degrees' is neither"):
            self.found(kind="ecdf", x="time_ns", series="variant")
        figure, points = self.found(kind="box", x="degrees", y="time_ns", series="variant")
        self.assertIn("of 3 values a box: 3 repetitions", self.texts(self.drawn(figure, points)))

    def test_tables(self):
        figure, points = self.found(kind="table", x="degrees", y="time_ns / pairs", series="strategy", panels="volume",
                                    interval="range")
        latex = tables.to_latex(figure, points)
        self.assertEqual(latex.count("\\begin{tabular}"), 2)
        self.assertIn("110 [100, 120]", latex)
        self.assertRegex(latex, r"rotation per frame \(\$\^\\circ\$\) & +recursive & +deferred")
        self.assertIn("% Medians of 3 repetitions; bars: least to largest.", latex)
        self.assertTrue(latex.isascii())
        frame = pd.read_csv(io.StringIO(tables.to_csv(figure, points)))
        self.assertEqual(len(frame), 12)
        self.assertEqual(list(frame["values"].unique()), [3])

    def test_files(self):
        record = own_record(self.folder)
        words = [str(record), "--x", "degrees", "--series", "variant", "--name", "mine"]
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(draw.main([*words, "--formats", "pdf,tex,csv"]), 0)
            self.assertEqual(draw.main([*words, "--kind", "table", "--name", "numbers"]), 0)
        names = {path.name for path in (record / "figures").iterdir()}
        self.assertEqual(names, {"mine.pdf", "mine.tex", "mine.csv", "numbers.tex", "numbers.csv"})

    def test_a_caption_beside_and_a_style(self):
        record, words = own_record(self.folder), ["--x", "degrees", "--series", "variant", "--y-label", "mine"]
        (self.folder / "paper.mplstyle").write_text("axes.labelsize: 20\nfont.family: serif\n")
        sizes = []
        for more in ([], ["--caption", "beside", "--style", str(self.folder / "paper.mplstyle")]):
            seen = Seen(self, lambda: draw.main([str(record), "--name", f"n{len(more)}", *words, *more]))
            self.assertEqual(seen.result, 0)
            self.assertEqual("Medians of 3 repetitions" in " ".join(seen.texts), not more)
            self.assertIn("mine", " ".join(seen.texts))
            sizes.append((record / "figures" / f"n{len(more)}.png").stat().st_size)
        self.assertNotEqual(sizes[0], sizes[1])
        self.assertIn("Medians of 3 repetitions", (record / "figures" / "n4.txt").read_text())
        (self.folder / "bad.mplstyle").write_text("axes.labelsize: enormous\n")
        for style, mention in ((str(self.folder / "bad.mplstyle"), "enormous"), ("no-such-style", "no such file")):
            said = io.StringIO()
            with contextlib.redirect_stderr(said):
                self.assertEqual(draw.main([str(record), *words, "--style", style]), 2)
            self.assertIn(mention, said.getvalue())
            self.assertEqual(said.getvalue().count("\n"), 1)

    def test_whoever_saves_a_figure_has_its_caption(self):
        drawing, heights = self.drawn(*self.found(x="degrees", series="variant")), []
        for keywords in ({}, dict(bbox_inches=drawing.bbox_inches)):
            with matplotlib.rc_context({"savefig.bbox": None}):
                drawing.savefig(self.folder / "a.png", dpi=50, **keywords)
            heights.append(plt.imread(self.folder / "a.png").shape[0])
        self.assertGreater(heights[0], 1.1 * heights[1])

    def test_small_multiples_stand_in_a_grid(self):
        found = self.found(x="degrees", y="time_ns", panels="volume", panel_rows="strategy", width="column")
        drawing = self.drawn(*found)
        self.assertEqual(len(drawing.axes), 4)
        self.assertAlmostEqual(drawing.get_figwidth(), 3.4)
        self.assertEqual([axis.get_title() for axis in drawing.axes], ["sphere", "obb", "", ""])


class Compares(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def record(self, change=None):
        return own_record(tempfile.mkdtemp(dir=self.folder), change=change)

    def compare(self, *words):
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            code = compare.main([str(word) for word in words])
        return code, said.getvalue()

    def changed(self, rows):
        """Spheres twice as fast, boxes 1.5 times as slow at ten degrees, and one count that is another."""
        factor = np.where(rows.volume == "sphere", 0.5, np.where(rows.degrees == 10, 1.5, 1))
        rows = rows.assign(time_ns=rows.time_ns * factor)
        rows.loc[(rows.degrees == 1) & (rows.volume == "obb") & (rows.strategy == "deferred"), "n_v"] += 1
        return rows

    def test_faster_slower_different(self):
        code, said = self.compare(self.record(), self.record(self.changed), "--csv", self.folder / "cells.csv")
        self.assertEqual(code, 0)
        cells = pd.read_csv(self.folder / "cells.csv", keep_default_na=False)
        self.assertEqual(cells.verdict.value_counts().to_dict(), {"faster": 6, "as before": 4, "slower": 2})
        for row in cells.itertuples():
            self.assertLessEqual(row.low, row.ratio)
            self.assertLessEqual(row.ratio, row.high)
        faster = cells[cells.verdict == "faster"]
        np.testing.assert_allclose(faster.ratio, 0.5)
        np.testing.assert_allclose(faster.low, 0.5 * 100 / 120)  # of three repetitions the range of quotients
        self.assertEqual(list(cells[cells.different != ""].different), ["n_v"])
        self.assertIn("6 faster, 4 as before, 2 slower; 1 different", said)
        self.assertEqual(said.count("faster  "), 6)

    def test_itself(self):
        record = self.record()
        code, said = self.compare(record, record)
        self.assertEqual(code, 0)
        self.assertIn("12 as before; geometric mean 1\n", said)

    def test_two_machines(self):
        """Times of two machines are compared, and that they are of two is said; records of one name are told apart."""
        records_of = []
        for machine in (dict(node="a", processor="AMD EPYC", cores=2, compiler="GNU 12.2.0", flags="-O3", clock="wall"),
                        dict(node="b", processor="Intel Xeon", cores=2, compiler="GNU 13.1.0", flags="-O3", clock="wall")):
            records_of.append(self.record())
            (records_of[-1] / "machine.json").write_text(json.dumps(machine))
        code, said = self.compare(*records_of)
        self.assertEqual(code, 0)
        self.assertEqual(said.splitlines()[:3], [
            f"time_ns / pairs of {records_of[1]} over {records_of[0]}: ratio of medians, 95 %",
            "TWO MACHINES: node a before, b after; processor AMD EPYC before, Intel Xeon after",
            "compiled otherwise: compiler GNU 12.2.0 before, GNU 13.1.0 after"])
        code, said = self.compare(records_of[0], self.record())
        self.assertIn("TWO MACHINES: node a before, unknown after", said)
        self.assertNotIn("MACHINES", self.compare(records_of[0], records_of[0])[1])

    def test_bootstrap_of_many(self):
        low, middle, high = comparing.ratio_of(np.linspace(90, 110, 21), np.linspace(180, 220, 21))
        self.assertAlmostEqual(middle, 2)
        self.assertTrue(1.8 < low < 2 < high < 2.2)

    def test_what_cannot_be_compared(self):
        other = self.record(lambda rows: rows.assign(degrees=rows.degrees * 7))
        for words, mention in (((self.record(), other), "no cell is in both"), ((self.record(), "none"), "no record"),
                               ((self.record(), other, "--value", "frob"), "no column 'frob'")):
            code, said = self.compare(*words)
            self.assertEqual((code, said.count("\n")), (2, 1), said)
            self.assertIn(mention, said)


OWN = """name = "mine"
repetitions = 2
[parameters]
mesh = "mine.obj"
objects = 3
frames = 20
[[axis]]
name = "degrees"
values = [0.5, 5]
[[axis]]
name = "volume"
values = ["sphere", "obb"]
[[axis]]
name = "strategy"
values = ["recursive", "deferred"]
[[figure]]
name = "panels"
x = "degrees"
y = "time_ns / pairs"
series = "strategy"
panels = "volume"
width = "page"
[[figure]]
name = "numbers"
kind = "table"
x = "degrees"
y = "time_ns / pairs"
series = "strategy"
panels = "volume"
"""


class EveryFigure(unittest.TestCase):
    """The definition that shows every kind: its record is made by the program, where there is one."""

    def test_it_declares_every_kind(self):
        declared, faults = figures.declared(records.read_toml(PLOTS.parent / "experiments/definitions/every-figure.toml"))
        self.assertEqual(faults, [])
        self.assertEqual({figure.kind or "line" for figure in declared}, set(figures.KINDS))

    def test_it_is_run_and_drawn(self):
        program = self.program()
        with tempfile.TemporaryDirectory() as folder:
            text = (PLOTS.parent / "experiments/definitions/every-figure.toml").read_text()
            (Path(folder) / "small.toml").write_text(text.replace("frames = 150", "frames = 20"))
            done = subprocess.run([program, "run", Path(folder) / "small.toml", "--record", Path(folder) / "record"],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            said = io.StringIO()
            with contextlib.redirect_stderr(said):
                seen = Seen(self, lambda: draw.main([f"{folder}/record"]), formats=("pdf", "png"))
            # Of times so short a fit may find volume tests free, and then terms are not stacked.
            refused = [line for line in said.getvalue().splitlines() if "volume tests would be free" not in line]
            self.assertEqual(refused, [])
            self.assertEqual(len(seen.paths) + said.getvalue().count("\n"), 11)
            names = {path.name for path in (Path(folder) / "record/figures").iterdir()}
            self.assertTrue({"numbers.tex", "numbers.csv", "line.pdf"} <= names)

    def test_a_definition_of_one_s_own_by_two_commands(self):
        """From a mesh in a file to a table of LaTeX and a figure of two panels, as README.md says it."""
        program = self.program()
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            (folder / "mine.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n")
            (folder / "mine.toml").write_text(OWN)
            for command in ([program, "run", "mine.toml", "--record", "mine"], [PLOTS / "draw", "mine"]):
                done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
                self.assertEqual((done.returncode, done.stderr), (0, ""), command)
            drawn = {path.name for path in (folder / "mine/figures").iterdir()}
            self.assertEqual(drawn, {"panels.pdf", "panels.png", "numbers.tex", "numbers.csv"})
            self.assertTrue((folder / "mine/figures/panels.pdf").read_bytes().startswith(b"%PDF"))
            latex = (folder / "mine/figures/numbers.tex").read_text()
            for word in ("tabular", "recursive", "deferred", "\\midrule"):
                self.assertIn(word, latex)
            figure, = [each for each in figures.declared(records.read_definition(folder / "mine"))[0] if each.kind != "table"]
            rows = kinds.Rows(folder / "mine").of(figure)
            self.assertEqual(len([axis for axis in kinds.drawing_of(figure, kinds.points_of(rows, figure)).axes if axis.has_data()]), 2)
            self.compiles(latex, folder)

    def compiles(self, latex, folder):
        """By LaTeX, where it is there."""
        if not shutil.which("pdflatex"):
            return
        (folder / "paper.tex").write_text("\\documentclass{article}\\usepackage{booktabs}\\begin{document}\n" + latex + "\\end{document}\n")
        done = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"], cwd=folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])

    def program(self):
        found = Path(os.environ.get("BVLAB", PLOTS.parent / "build/release/bvlab"))
        if not found.is_file():
            self.skipTest("there is no program")
        return found


if __name__ == "__main__":
    unittest.main()
