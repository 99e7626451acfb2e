# SPDX-License-Identifier: BSD-3-Clause
"""plots/draw: every record in the repository, names that nobody has heard of, and what it refuses."""

import contextlib
import csv
import io
import resource
import subprocess
import tempfile
import unittest
from pathlib import Path

from drawing import Seen
from small_records import COUNTS, PLOTS, ROOT, STRATEGIES, names_added, own_record, small_record, stranger

from bvlab_plots import draw, figures, records


RECURSIVE = dict(strategy="recursive")
METHODS = ("hybrid", [stranger("method"), "grid", "brute-force"])
# Definition, how much of its record, the strangers added, and what a peer is made of.
STRANGE = [
    ("best-rebuilds", dict(motion=3), dict(strategy=("deferred", STRATEGIES)), RECURSIVE),
    ("boxes-displacement", dict(set=1, displacement=4), dict(method="blocks", set="random"), None),
    ("boxes-fast", dict(set=2), dict(method=("blocks", METHODS[1]), set="random", motion="drift"), None),
    ("boxes-figures-4-5", dict(boxes=3), dict(method=METHODS), None),
    ("closest-features", dict(motion=2, mesh=2), dict(strategy=("recursive", STRATEGIES), mesh="icosphere:80"),
     RECURSIVE),
    ("distance-error", dict(relative_error=3), dict(volume="sphere", mesh="knot"), None),
    ("hierarchies", dict(work=2, motion=1), dict(volume="sphere", strategy=("recursive", STRATEGIES), density="dense"),
     RECURSIVE),
    ("worlds", dict(objects=1), dict(volume="obb", strategy=("deferred", STRATEGIES)), RECURSIVE),
]


class Draws(unittest.TestCase):
    def test_every_record_of_the_repository(self):
        folders = sorted(path.parent for path in (ROOT / "experiments" / "record").glob("*/definition.toml"))
        self.assertTrue(folders)
        for folder in folders:
            with self.subTest(folder.name), tempfile.TemporaryDirectory() as out:
                seen = Seen(self, lambda: draw.main([str(folder), "--out", out]))
                self.assertEqual(seen.result, 0)
                self.assertTrue(seen.paths)

    def test_every_definition_declares_figures_that_are_taken(self):
        declared = 0
        for path in (ROOT / "experiments" / "definitions").glob("*.toml"):
            with self.subTest(path.name):
                declared += len(figures.declared(records.read_toml(path)))
        self.assertGreater(declared, 30)

    def test_names_that_nobody_has_heard_of(self):
        for name, keep, strangers, peer_like in STRANGE:
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                record = small_record(name, Path(folder) / "record", keep, strangers, peer_like)
                seen = Seen(self, lambda: draw.main([str(record), "--out", folder]))
                self.assertEqual(seen.result, 0)
                seen.check(self, names_added(strangers, peer_like))

    def test_a_definition_that_declares_nothing_has_a_figure_of_each_axis(self):
        with tempfile.TemporaryDirectory() as folder:
            seen = Seen(self, lambda: draw.main([str(own_record(folder)), "--out", folder]))
            self.assertEqual({path.stem for path in seen.paths}, {"by-degrees", "by-volume", "by-strategy"})

    def test_declared_in_the_record_itself_and_by_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            table = '[[figure]]\nname = "mine"\nx = "degrees"\nover = "strategy=recursive"\nseries = "strategy"\n'
            record = own_record(folder, more=table + 'panels = "volume"\n')
            seen = Seen(self, lambda: draw.main([str(record)]), formats=("pdf", "png"))
            self.assertEqual(seen.paths, [record / "figures" / "mine.png"])
            self.assertIn("time per pair over recursive's", " ".join(seen.texts).replace("\n", " "))
            for words in (["--x", "degrees", "--y", "n_v / pairs", "--series", "volume", "--pool", "strategy"],
                          ["--x", "volume, strategy", "--kind", "bars", "--over", "best", "--panels", "degrees"],
                          ["--x", "degrees", "--y", "volume", "--kind", "map", "--series", "strategy"],
                          ["--x", "n_v", "--panels", "volume, strategy", "--where", "degrees!=1"]):
                seen = Seen(self, lambda: draw.main([str(record), "--out", folder, *words]))
                self.assertEqual((seen.result, len(seen.paths)), (0, 1), words)
                seen = Seen(self, lambda: draw.main([str(record), "--table", *words]))
                self.assertEqual((seen.result, len(seen.paths)), (0, 0), words)
                self.assertIn("sphere", seen.printed)


    def test_odd_names(self):
        names = {"deferred": "_x$y_$\\frac", "obb": "a_b%c#$"}
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder, change=lambda rows: rows.replace(names))
            for words in ([], ["--x", "volume, degrees", "--y", "strategy", "--kind", "map"],
                          ["--x", "degrees", "--y", "n_v", "--kind", "map", "--series", "variant", "--over", "best"],
                          ["--x", "variant", "--series", "variant", "--kind", "bars", "--pool", "degrees"]):
                seen = Seen(self, lambda: draw.main([str(record), "--out", folder, *words]))
                self.assertEqual(seen.result, 0)
                self.assertIn("x\\$y_", " ".join(seen.texts))

    def test_records_of_hardly_anything(self):
        for change in (lambda rows: rows.iloc[:1], lambda rows: rows.assign(time_ns=0),
                       lambda rows: rows.assign(time_ns=-rows.time_ns), lambda rows: rows.assign(volume="")):
            with tempfile.TemporaryDirectory() as folder:
                record = own_record(folder, change=change)
                self.assertEqual(Seen(self, lambda: draw.main([str(record), "--out", folder])).result, 0)


class Refuses(unittest.TestCase):
    """One line that names what there is instead, exit 2, and nothing written."""

    def refuse(self, record, *words, mentions=()):
        said = io.StringIO()
        out = Path(record) / "never"
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            code = draw.main([str(record), "--out", str(out), *words])
        self.assertEqual((code, said.getvalue().count("\n")), (2, 1), said.getvalue())
        self.assertFalse(out.exists())
        for mention in (str(record), *mentions):
            self.assertIn(mention, said.getvalue())

    def test_columns_expressions_and_variants(self):
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder)
            for words, mentions in (
                    (["--x", "frob"], ["'frob'", "degrees", "time_ns"]),
                    (["--x", "degrees, frob"], ["'frob'", "degrees"]),
                    (["--x", "degrees", "--y", "time_ns / frob"], ["'frob'", "pairs"]),
                    (["--x", "degrees", "--y", "time_ns /"], ["'time_ns /'"]),
                    (["--x", "degrees", "--y", "__import__('os')"], ["no expression"]),
                    (["--x", "degrees", "--y", "time_ns.mean"], ["no expression"]),
                    (["--x", "degrees", "--y", "volume / 2"], ["'volume' holds names"]),
                    (["--x", "degrees", "--y", "volume"], ["holds names"]),
                    (["--x", "degrees", "--y", "time_ns + pairs"], ["same unit"]),
                    (["--x", "degrees", "--y", "time_ns ** 9 ** 9 ** 9"], ["time_ns ** 9"]),
                    (["--x", "degrees", "--series", "frob"], ["series", "'frob'", "volume"]),
                    (["--x", "degrees", "--panels", "frob"], ["panels", "'frob'", "volume"]),
                    (["--x", "degrees", "--over", "strategy=frob"], ["'frob'", "'recursive'", "'deferred'"]),
                    (["--x", "degrees", "--over", "frob=1"], ["'frob'", "strategy"]),
                    (["--x", "degrees", "--over", "frob"], ["best peer"]),
                    (["--x", "degrees", "--over", "best peer"], ["best peer"]),
                    (["--x", "degrees", "--where", "volume=frob"], ["'frob'", "'sphere'"]),
                    (["--x", "degrees", "--where", "frob=1"], ["frob"]),
                    (["--x", "degrees", "--series", "strategy"], ["'volume' is neither named nor fixed"]),
                    (["--x", "degrees", "--pool", "frob"], ["pool", "'frob'"]),
                    (["--x", "degrees", "--formats", "gif"], ["'gif'", "csv"]),
                    (["--x", "volume", "--y", "n_v", "--kind", "scatter"], ["holds names"]),
                    (["--x", "degrees", "--where", "pairs"], ["no condition"]),
                    (["--x", "degrees", "--where", "pairs>1000000"], ["no row is left"]),
                    (["--x", "degrees", "--kind", "pie"], ["'pie'", "line, bars, map"]),
                    (["--x", "degrees", "--kind", "map"], ["needs a y"]),
                    (["--x", "degrees", "--log", "z"], ["'z'", "xy"]),
                    (["--x", "degrees", "--name", "a/b"], ["'/'"]),
                    (["--y", "time_ns"], ["--x"])):
                with self.subTest(words):
                    self.refuse(record, *words, mentions=mentions)

    def test_figures_of_definitions(self):
        for table, mention in (('name = "a"\n', "needs an x"), ('x = "degrees"\n', "needs a name"),
                               ('name = "a"\nx = 3\n', "x must be a string"),
                               ('name = "a"\nx = "degrees"\nwhere = "volume=obb"\n', "list of strings"),
                               ('name = "a"\nx = "degrees"\nfrob = "1"\n', "'frob'"),
                               ('name = "a"\nx = "degrees"\nkind = "scatter"\n', "needs a y"),
                               ('name = "a"\nx = "degrees"\nfit = "power"\n', "through a scatter"),
                               ('name = "a"\nx = "degrees"\nstatistic = "mode"\n', "median, mean")):
            with self.subTest(table), tempfile.TemporaryDirectory() as folder:
                self.refuse(own_record(folder, more="[[figure]]\n" + table), mentions=[mention])

    def test_a_figure_that_cannot_be_drawn_stops_no_other(self):
        table = ('[[figure]]\nname = "{0}"\nx = "{1}"\nseries = "strategy"\npanels = "volume"\n')
        tables = "".join(table.format(*each) for each in (("a", "degrees"), ("b", "frob"), ("a", "degrees"),
                                                          ("c", "degrees")))
        with tempfile.TemporaryDirectory() as folder:
            record, said = own_record(folder, more=tables), io.StringIO()
            with contextlib.redirect_stderr(said):
                seen = Seen(self, lambda: draw.main([str(record)]))
            self.assertEqual(({path.stem for path in seen.paths}, seen.result), ({"a", "c"}, 2))
            self.assertEqual(said.getvalue().count("\n"), 2)
            for mention in ("figure b: 'frob': no column 'frob'", "second figure 'a'"):
                self.assertIn(mention, said.getvalue())

    def test_of_counts_alone_counts_are_drawn(self):
        tables = "".join(f'[[figure]]\nname = "{y}"\nx = "degrees"\ny = "{y} / pairs"\nseries = "variant"\n'
                         for y in ("time_ns", "n_v"))
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder, more=tables, change=lambda rows: rows.assign(time_ns=""))
            said = io.StringIO()
            with contextlib.redirect_stderr(said):
                seen = Seen(self, lambda: draw.main([str(record)]))
            self.assertEqual([path.stem for path in seen.paths], ["n_v"])
            self.assertIn("time_ns", said.getvalue())

    def test_answers_that_nobody_compared(self):
        with tempfile.TemporaryDirectory() as folder:
            self.refuse(own_record(folder, change=lambda rows: rows.drop(columns="differing")), mentions=["differing"])
        with tempfile.TemporaryDirectory() as folder:
            self.refuse(own_record(folder, change=lambda rows: rows.assign(differing="")), mentions=["36 of 36 rows"])

    def test_a_table_that_is_cut_off(self):
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder)
            text = (record / "own.csv").read_text()
            (record / "own.csv").write_text(text[:-4])
            self.refuse(record, mentions=["own.csv", "cut off"])

    def test_damaged_numbers(self):
        """A time or a count that is none would be left out of a median without a word."""
        for column in ("time_ns", "n_v"):
            for wrong in ("12.3.4", "1e999"):
                def damaged(rows):
                    rows = rows.astype({column: object})
                    rows.loc[rows.index[3], column] = wrong
                    return rows
                with tempfile.TemporaryDirectory() as folder:
                    self.refuse(own_record(folder, change=damaged), mentions=["own.csv: row 4", column, "is no number"])

    def test_an_unfinished_record_says_so_in_its_figures(self):
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder)
            (record / "unfinished.json").write_text('{"what": "rows", "done": 0, "all": 72}')
            seen = Seen(self, lambda: draw.main([str(record), "--out", folder]))
            self.assertIn("unfinished: 36 of 72 rows", seen.printed)
            self.assertIn("UNFINISHED: 36 of 72 rows", " ".join(seen.texts).replace("\n", " "))

    def test_marks_and_breaks(self):
        """A mark of the byte order before definition and table, and a carriage return in a name."""
        odd = {"deferred": "defer\rred", "recursive": 'recur\r\n"sive'}
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder)
            rows = records.read_table(record / "own.csv").replace(odd)
            rows.to_csv(record / "own.csv", index=False, quoting=csv.QUOTE_NONNUMERIC)  # as bvlab quotes them
            for file in ("own.csv", "definition.toml"):
                content = (record / file).read_bytes()
                (record / file).write_bytes(b"\xef\xbb\xbf" + content)
            self.assertEqual(set(records.read(record).strategy), set(odd.values()))
            self.assertEqual(Seen(self, lambda: draw.main([str(record), "--out", folder])).result, 0)

    def test_answers_that_differ(self):
        def differing(rows):
            rows.loc[rows.index[3], "differing"] = 1
            return rows

        with tempfile.TemporaryDirectory() as folder:
            self.refuse(own_record(folder, change=differing), mentions=["differ from the reference"])

    def test_a_full_disk(self):
        """Wherever it fills up, also where matplotlib is in the midst of a file: one line that names it, no half a file."""
        with tempfile.TemporaryDirectory() as folder:
            record = own_record(folder, more='[[figure]]\nname = "mine"\nx = "degrees"\nseries = "variant"\n')
            for most in (0, 2000, 4096, 9000, 12000, 16000):
                out = Path(folder) / f"out-{most}"
                done = subprocess.run([PLOTS / "draw", record, "--out", out], capture_output=True, text=True, check=False,
                                      preexec_fn=lambda most=most: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
                self.assertEqual(done.returncode, 1, most)
                self.assertRegex(done.stderr, r"\Adraw: .*/mine\.(pdf|png): File too large\n\Z")
                self.assertLessEqual({path.name for path in out.iterdir()}, {"mine.pdf"})
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([PLOTS / "draw", record, "--table"], stdout=full, stderr=subprocess.PIPE, text=True,
                                      check=False)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)

    def test_what_is_no_record(self):
        with tempfile.TemporaryDirectory() as folder:
            self.refuse(Path(folder), mentions=["no record"])
            record = own_record(folder)
            for content, mention in (("", "own.csv"), ("degrees,time_ns\n", "no rows")):
                (record / "own.csv").write_text(content)
                self.refuse(record, mentions=[mention])
            for value in (float("nan"), float("inf")):
                with tempfile.TemporaryDirectory() as other:
                    self.refuse(own_record(other, change=lambda rows, v=value: rows.assign(time_ns=v)),
                                mentions=["time_ns"])
            (record / "own.csv").unlink()
            self.refuse(record, mentions=["own.csv"])
            with tempfile.TemporaryDirectory() as other:
                self.refuse(own_record(other), "--out", str(record / "definition.toml" / "figures"),
                            mentions=["definition.toml", "no folder"])
            for text, mention in (("figure = 3", "[[figure]]"), ("axis = 3", "[[axis]]"), ("figure = [1]", "[[figure]]"),
                                  ("parameters = 3", "no table")):
                (record / "definition.toml").write_text(f"name = 'own'\n{text}\n")
                self.refuse(record, mentions=[mention])
            (record / "definition.toml").write_text("name = \n")
            self.refuse(record, mentions=["definition.toml"])


if __name__ == "__main__":
    unittest.main()
