# SPDX-License-Identifier: BSD-3-Clause
"""Records that grow: killed within one trace, given more values, repetitions, measures and figures; how far a run says
it is; and what is refused before the first cell."""

import csv
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from program import BVLAB, ProgramTest, names_of

ROOT = pathlib.Path(__file__).resolve().parents[3]
START = """
name = "grow"
repetitions = {repetitions}
{more}
[parameters]
mesh = "torus"
polygons = 200
objects = 3
frames = {frames}
[[axis]]
name = "seed"
values = {seeds}
[[axis]]
name = "strategy"
values = {strategies}
"""
LISTS = ["recursive", "deferred", "separation-list", "by-cost", "raise", "margins"]


def definition(repetitions=2, seeds=(1,), strategies=("recursive", "deferred"), frames=40, more="", end=""):
    strategies = json.dumps(list(strategies))
    return START.format(repetitions=repetitions, seeds=list(seeds), strategies=strategies, frames=frames, more=more) + end


def figure(**keys):
    return "[[figure]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())


class GrowTest(ProgramTest):
    def rows(self, table="grow.csv"):
        with open(self.folder / "record" / table, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def run_it(self, text):
        self.write("grow.toml", text)
        return self.take("run", "grow.toml", "--record", "record")

    def key(self, row):
        return row["seed"], row["strategy"], row["repetition"]


class Grows(GrowTest):
    def test_more_values_repetitions_measures_and_figures(self):
        self.run_it(definition())
        before = {self.key(row): row for row in self.rows()}
        for text, rows in ((definition(repetitions=3), 2 * 3),
                           (definition(3, seeds=(2, 1, 3)), 3 * 2 * 3),
                           (definition(3, (2, 1, 3), LISTS), 3 * 6 * 3),
                           (definition(3, (2, 1, 3), LISTS, more='measures = ["coherence"]'), 3 * 6 * 3),
                           (definition(3, (2, 1, 3), LISTS, more='measures = ["coherence", "predictions"]',
                                       end=figure(name="mine", x="strategy", y="n_v")), 3 * 6 * 3)):
            self.run_it(text)
            grown = {self.key(row): row for row in self.rows()}
            self.assertEqual((len(grown), len(self.rows())), (rows, rows))
            # What was there has not been run again: its times are the same.
            self.assertEqual({key: grown[key] for key in before}, before)
            self.assertEqual((self.folder / "record/definition.toml").read_text(), text)
            before = grown
        self.assertEqual(len(self.rows("grow.coherence.csv")), 3)
        self.assertEqual(len({row["strategy"] for row in self.rows("grow.predictions.csv")}), len(names_of("strategies")))
        # In the order of the definition, and counts as those of a run at once.
        self.assertEqual([row["seed"] for row in self.rows()], ["2"] * 18 + ["1"] * 18 + ["3"] * 18)
        self.take("run", "grow.toml", "--record", "at-once")
        with open(self.folder / "at-once/grow.csv", newline="", encoding="utf-8") as file:
            counts = {self.key(row): (row["n_v"], row["n_p"], row["front"], row["differing"]) for row in csv.DictReader(file)}
        self.assertEqual({key: (row["n_v"], row["n_p"], row["front"], row["differing"]) for key, row in before.items()}, counts)
        names = [{path.name for path in (self.folder / record).iterdir()} for record in ("record", "at-once")]
        self.assertEqual(*names)

    def test_a_series_that_comes_later(self):
        self.run_it(definition())
        times = [row["time_ns"] for row in self.rows()]
        self.run_it(definition(end='[series]\nstrategy = "deferred"\n'))
        self.assertEqual(len(self.rows("grow.frames.csv")), 40)
        self.assertEqual([row["time_ns"] for row in self.rows()], times)

    def test_what_is_no_growth(self):
        self.run_it(definition(repetitions=2, seeds=(1, 2), more='measures = ["coherence"]'))
        kept = 'measures = ["coherence"]'
        for text, said in ((definition(1, (1, 2), more=kept), "it has 2 repetitions"),
                           (definition(2, (1, 3), more=kept), "seed = 2, strategy = recursive is not in the definition"),
                           (definition(2, (1, 2), frames=41, more=kept), "is not in the definition"),
                           (definition(2, (1, 2)), "it measures coherence")):
            self.write("grow.toml", text)
            self.refuse("run", "grow.toml", "--record", "record", mentions=["record", "another definition", said])

    def test_a_study_goes_on_with_other_figures_alone(self):
        study = 'name = "grow"\nkind = "triangles"\nrepetitions = 1\n[parameters]\npairs = 200\n'
        self.run_it(study)
        self.run_it(study + figure(name="mine", x="test", y="false_positives", pool="set"))
        self.write("grow.toml", study.replace("200", "300"))
        self.refuse("run", "grow.toml", "--record", "record", mentions="another definition")

    def test_who_went_on_with_it_is_known(self):
        self.run_it(definition())
        machine = self.folder / "record/machine.json"
        first = json.loads(machine.read_text())
        machine.write_text(json.dumps(first | {"commit": "0" * 40, "changes": False}))
        self.run_it(definition(repetitions=3))
        grown = json.loads(machine.read_text())
        self.assertEqual(grown["commit"], "0" * 40)
        self.assertEqual(grown["later"][0]["commit"], first["commit"])
        self.assertIn("grow.toml", grown["later"][0]["command"])
        self.assertEqual(grown["changes"], first["changes"] or False)

    def test_the_clock_of_frames_is_known(self):
        source, library = ROOT / "experiments/processor_time.c", self.folder / "processor_time.so"
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", source, "-o", library], check=True)
        self.write("grow.toml", definition(more='measures = ["frames"]'))
        # A sanitizer's library wants to be the first; here it need not be.
        environment = os.environ | {"LD_PRELOAD": str(library), "ASAN_OPTIONS": "verify_asan_link_order=0"}
        subprocess.run([BVLAB, "run", "grow.toml", "--record", "record"], cwd=self.folder, env=environment, check=True,
                       capture_output=True)
        machine = json.loads((self.folder / "record/machine.json").read_text())
        self.assertEqual((machine["clock"], machine.get("later")), ("processor", None))
        self.run_it(definition(repetitions=3, more='measures = ["frames"]'))
        machine = json.loads((self.folder / "record/machine.json").read_text())
        self.assertEqual([part["clock"] for part in machine["later"]], ["wall"])


class Killed(GrowTest):
    def killed(self, text, enough):
        """Killed as soon as `enough` is so."""
        self.write("grow.toml", text)
        with subprocess.Popen([BVLAB, "run", "grow.toml", "--record", "record"], cwd=self.folder,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            end = time.monotonic() + 60
            while not enough() and process.poll() is None:
                self.assertLess(time.monotonic(), end)
                time.sleep(0.005)
            self.assertIsNone(process.poll(), "it was over too soon")
            process.send_signal(signal.SIGKILL)

    def count(self, table):
        path = self.folder / "record" / table
        return path.read_text().count("\n") - 1 if path.is_file() else 0

    def test_within_one_trace(self):
        """What the issue found: 50 s of a study with one trace, and no row."""
        text = definition(repetitions=5, strategies=LISTS, frames=3000)
        self.killed(text, lambda: self.count("grow.counted.csv") >= 2)
        counted = self.count("grow.counted.csv")
        self.killed(text, lambda: self.count("grow.csv") >= 4)
        self.assertEqual(self.count("grow.counted.csv"), len(LISTS))
        self.assertGreaterEqual(counted, 2)
        rows = self.rows()
        self.assertGreaterEqual(len(rows), 4)
        self.assertEqual(json.loads((self.folder / "record/unfinished.json").read_text())["all"], 30)
        self.take("run", "grow.toml", "--record", "record")
        finished = self.rows()
        self.assertEqual(len(finished), 30)
        known = [tuple(row.items()) for row in finished]
        self.assertTrue(all(tuple(row.items()) in known for row in rows))
        self.assertEqual({row["differing"] for row in finished}, {"0"})
        self.assertFalse((self.folder / "record/unfinished.json").exists())
        self.assertFalse((self.folder / "record/grow.counted.csv").exists())

    def test_a_line_cut_off_by_a_kill_is_run_again(self):
        self.run_it(definition())
        table = self.folder / "record/grow.csv"
        table.write_bytes(table.read_bytes()[:-7])
        self.refuse("run", "grow.toml", "--record", "record", mentions="is cut off")
        self.write("record/unfinished.json", '{"what": "rows", "done": 3, "all": 4}\n')
        self.take("run", "grow.toml", "--record", "record")
        self.assertEqual(len(self.rows()), 4)

    def test_who_holds_a_record_is_named(self):
        self.write("grow.toml", definition(repetitions=3, strategies=LISTS, frames=3000))
        with subprocess.Popen([BVLAB, "run", "grow.toml", "--record", "record"], cwd=self.folder,
                              stdout=subprocess.DEVNULL) as first:
            while not (self.folder / "record/unfinished.json").exists():
                time.sleep(0.01)
            with subprocess.Popen([BVLAB, "run", "grow.toml", "--record", "record"], cwd=self.folder, text=True,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as second:
                said = second.stderr.readline()
                second.kill()
            first.kill()
        self.assertRegex(said, rf"record: waiting for another run to end by process {first.pid} \(.*bvlab run grow.toml")


class Says(GrowTest):
    def test_how_far_it_is_without_a_terminal(self):
        self.write("grow.toml", definition(repetitions=3, strategies=LISTS, frames=1500))
        done = self.run_bvlab("run", "grow.toml", "--record", "record", "--progress", "0.05")
        lines = done.stderr.splitlines()
        self.assertGreater(len(lines), 2)
        for line in lines:
            self.assertRegex(line, r"\Abvlab: \d+ of 24(, [\d.]+ (s|min) left)?(; \d+ runs repeated .*)?\Z")
        self.assertIn(" 24 of 24", lines[-1])
        # A quick run says nothing.
        self.take("run", "grow.toml", "--record", "other", "--counts")

    def test_code_from_outside_is_named_with_its_hash(self):
        with tempfile.TemporaryDirectory() as folder:
            header, out = pathlib.Path(folder) / "mine.hpp", pathlib.Path(folder) / "commit.hpp"
            header.write_text("struct Mine;\n")
            for outside, changes in ((f"-DOUTSIDE={header}", '"yes"'), ("-DOUTSIDE=", '"')):
                subprocess.run(["cmake", f"-DSOURCE={ROOT}", f"-DHEADER={out}", "-DGIT=git", outside, "-P",
                                ROOT / "experiments/recorder/commit.cmake"], check=True)
                self.assertIn(f"changes[] = {changes}", out.read_text())
                hashed = hashlib.sha256(header.read_bytes()).hexdigest()
                self.assertEqual(f'{{R"({header})", "{hashed}"}}' in out.read_text(), "mine.hpp" in outside)


class Refused(GrowTest):
    """Before the first cell is run, in one line."""

    def test_series_that_match_no_cell(self):
        for series, said in (('seed = 7', "series: seed has no '7'; available: '1'"),
                             ('strategy = "frob"', "series: strategy has no 'frob'"), ('frob = 1', "unknown 'frob'")):
            self.write("grow.toml", definition(end=f"[series]\n{series}\n"))
            self.refuse("run", "grow.toml", "--record", "record", mentions=["grow.toml", said])

    def test_figures_that_cannot_be_drawn(self):
        whole = dict(name="mine", x="strategy", y="time_ns / pairs")
        for keys, said in ((dict(y="time_sn / pairs"), "y: no column 'time_sn'; available: "),
                           (dict(x="strategi"), "x: no column 'strategi'"), (dict(series="frob"), "series: no column"),
                           (dict(panels="frob, seed"), "panels: no column"), (dict(pool="frob"), "pool: no column"),
                           (dict(where=["frob=1"]), "where: no column"), (dict(where=["seed=9"]), "seed has no '9'"),
                           (dict(where=["frob > 1e6"]), "no column 'frob'"),
                           (dict(over="strategy=frob"), "over strategy=frob: strategy has no 'frob'"),
                           (dict(y="survival"), "no column 'survival'"),
                           (dict(table="frames", y="n_v"), "no column 'n_v'"),
                           (dict(x="seed"), "axis 'strategy' is neither named nor fixed"),
                           (dict(fit="power"), "through a scatter"), (dict(kind="scatter", y=""), "needs a y"),
                           (dict(interval="sd"), "unknown interval 'sd'"),
                           (dict(y="time_ns, n_v", pool="seed"), "are not measured in the same unit"),
                           (dict(kind="stacked", y="n_v"), "y of stacked terms is a time"),
                           (dict(kind="scatter"), "'strategy' holds names"),
                           (dict(where=["n_v > 'x'"]), "'n_v > 'x''"),
                           (dict(x="seed", where=["strategy=deferred", "strategy=recursive"]), "'recursive'")):
            self.write("grow.toml", definition(seeds=(1, 2), end=figure(**(whole | keys))))
            self.refuse("run", "grow.toml", "--record", "record", mentions=["grow.toml: line ", said])
        study = 'name = "grow"\nkind = "triangles"\nrepetitions = 1\n[parameters]\npairs = 200\n'
        self.write("grow.toml", study + figure(name="mine", x="tset", y="false_positives"))
        done = self.run_bvlab("run", "grow.toml", "--record", "record")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no column 'tset'", done.stderr)

    def test_without_a_python_that_draws_figures_are_not_checked(self):
        self.write("grow.toml", definition(end=figure(name="mine", x="strategi")))
        self.write("pandas.py", "raise ImportError('it is not here')\n")
        done = self.run_bvlab("run", "grow.toml", "--parts", env=os.environ | {"PYTHONPATH": str(self.folder)})
        self.assertEqual((done.returncode, json.loads(done.stdout)["cells"]), (0, 2))
        self.assertEqual(done.stderr, "bvlab: figures were not checked: ImportError: it is not here\n")

    def test_figures_that_can(self):
        measured = 'measures = ["coherence"]'
        for keys in (dict(x="strategy", y="1e6 * time_ns / pairs, p99_ns, worst_ns", pool="seed"),
                     dict(x="survival", y="time_ns", over="strategy=recursive", ratio="speedup"),
                     dict(x="variant", y="n_v", where=["seed != 1 and strategy == 'deferred'", "step=0.5leaf"]),
                     dict(x="seed", series="strategy", over="record=elsewhere"),
                     dict(kind="map", x="seed", y="strategy", value="n_v"), dict(kind="stacked", x="strategy")):
            text = definition(more=measured, end=figure(name="mine", **keys)).replace("frames = 40", "frames = 3\nstep = '0.5leaf'")
            self.write("grow.toml", text)
            self.take("run", "grow.toml", "--parts")


if __name__ == "__main__":
    unittest.main()
