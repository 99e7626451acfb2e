# SPDX-License-Identifier: BSD-3-Clause
"""experiments/records: what is out of date is made, what is not is left; disturbed rows are made again; a record that
fails leaves the old one. The program here is a small one that writes what its definition says."""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from sweeping import ROOT

PROGRAM = '''#!{python}
import csv, json, os, pathlib, sys, tomllib
definition = tomllib.loads(pathlib.Path(sys.argv[2]).read_text())
if definition.get("fails"):
    sys.exit("first line\\nbvlab: it cannot be done")
folder = pathlib.Path(sys.argv[4])
folder.mkdir(parents=True, exist_ok=True)
table = folder / (definition["name"] + ".csv")
held = list(csv.DictReader(table.open())) if table.exists() else []
times = pathlib.Path("times")  # how often it has been called
count = int(times.read_text()) if times.exists() else 0
times.write_text(str(count + 1))
rows = {{row["seed"]: row for row in held}}
for seed in range(definition.get("seeds", 1)):
    new = {{"seed": str(seed), "made": str(count), "alone": "no" if str(seed) in definition.get("busy", "") else "yes"}}
    rows.setdefault(str(seed), new)
with table.open("w") as file:
    writer = csv.DictWriter(file, ["seed", "made", "alone"])
    writer.writeheader()
    writer.writerows(rows.values())
(folder / "definition.toml").write_text(pathlib.Path(sys.argv[2]).read_text())
(folder / "command.txt").write_text("bvlab run elsewhere\\n")
clock = "processor" if os.environ.get("LD_PRELOAD") else "wall"
machine = {{"commit": "{commit}", "changes": {changes}, "clock": clock, "words": sys.argv[5:]}}
(folder / "machine.json").write_text(json.dumps(machine))
'''


class Made(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="of records ")))
        (self.root / "experiments/definitions").mkdir(parents=True)
        (self.root / "experiments/record").mkdir()
        shutil.copy(ROOT / "experiments/records", self.root / "experiments")
        self.program_of("b")

    def program_of(self, commit, changes=False):
        program = self.root / "program"
        program.write_text(PROGRAM.format(python=sys.executable, commit=commit, changes=changes))
        program.chmod(0o755)

    def hold(self, name, text="", command="bvlab run elsewhere", commit="a"):
        (self.root / f"experiments/definitions/{name}.toml").write_text(f'name = "{name}"\n{text}')
        folder = self.root / "experiments/record" / name
        folder.mkdir(exist_ok=True)
        (folder / "machine.json").write_text(json.dumps({"commit": commit}))
        for file in ("definition.toml", f"{name}.csv"):
            (folder / file).write_text("")
        (folder / "command.txt").write_text(command + "\n")

    def make(self, *words):
        return subprocess.run([sys.executable, self.root / "experiments/records", self.root / "program", *words], cwd=self.root,
                              env={**os.environ, "BVLAB_MEMORY_AS_IT_IS": "1"}, capture_output=True, text=True, check=False)

    def machine(self, name):
        return json.loads((self.root / f"experiments/record/{name}/machine.json").read_text())

    def rows(self, name):
        with open(self.root / f"experiments/record/{name}/{name}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_what_is_out_of_date_is_made(self):
        self.hold("old", '[[figure]]\nname = "a"\nkind = "bars"\n', command="bvlab run elsewhere --counts")
        self.hold("study", 'kind = "boxes"\n')
        self.hold("new", commit="b")
        self.assertEqual(self.make("--list").stdout.split(), ["old", "study"])
        done = self.make()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(str((self.root / "experiments/record/old/definition.toml").readlink()), "../../definitions/old.toml")
        self.assertEqual(self.machine("old"), {"commit": "b", "changes": False, "clock": "wall", "words": ["--counts"]})
        self.assertEqual(self.machine("study")["clock"], "wall")
        self.assertEqual(self.machine("new"), {"commit": "b"})
        command = (self.root / "experiments/record/old/command.txt").read_text()
        self.assertEqual(command, "bvlab run experiments/definitions/old.toml --record experiments/record/old --counts\n")
        self.assertEqual(self.make("--list").stdout, "")

    def test_a_change_ages_what_it_is_measured_by(self):
        def git(*words):
            return subprocess.run(["git", "-c", "user.name=nobody", "-c", "user.email=nobody", *words], cwd=self.root, check=True,
                                  capture_output=True, text=True).stdout.strip()

        def commit(**changed):
            for name, text in changed.items():
                path = self.root / f"{name.replace('_', '/')}.hpp"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            git("add", "-A")
            git("commit", "-q", "--allow-empty", "-m", "a change")
            return git("rev-parse", "HEAD")

        git("init", "-q")
        self.hold("boxes", 'kind = "boxes"\n')
        self.hold("pairs")
        old = commit(broadphase_grid='#include "hierarchies/geometry/near.hpp"\n', hierarchies_geometry_far="int far;\n",
                     hierarchies_geometry_near='#include "hierarchies/sorted.hpp"\n', hierarchies_sorted="int sorted;\n")
        for changed, due in (({"hierarchies_sorted": "// As it was.\nint sorted;\n"}, []),
                             ({"hierarchies_geometry_far": "int farther;\n"}, ["pairs"]),
                             ({"hierarchies_sorted": "int sorted_twice;\n"}, ["boxes", "pairs"])):
            for name, text in (("boxes", 'kind = "boxes"\n'), ("pairs", "")):
                self.hold(name, text, commit=old)
            old = commit(**changed)
            self.program_of(old)
            self.assertEqual(self.make("--list").stdout.split(), due)

    def test_disturbed_rows_are_made_again_twice_at_most(self):
        self.hold("some", 'seeds = 5\nbusy = "03"\n')
        self.hold("most", 'seeds = 3\nbusy = "02"\n')
        self.assertEqual(self.make("--only", "some", "most").returncode, 0)
        # The first call asks for the commit.
        self.assertEqual({row["seed"]: row["made"] for row in self.rows("some")},
                         {"0": "3", "3": "3", "1": "1", "2": "1", "4": "1"})
        self.assertEqual({row["made"] for row in self.rows("most")}, {"4"})

    def test_one_that_fails_leaves_the_old_one(self):
        self.hold("bad", "fails = true\n")
        self.hold("good")
        done = self.make()
        self.assertEqual(done.returncode, 1)
        self.assertIn("bad (bvlab: it cannot be done)", done.stderr)
        self.assertEqual((self.machine("bad")["commit"], self.machine("good")["commit"]), ("a", "b"))

    def test_what_a_run_does_not_write_stays(self):
        self.hold("old")
        for name in ("old.md", "unit-costs.json"):
            (self.root / "experiments/record/old" / name).write_text(name)
        done = self.make()
        self.assertEqual(self.machine("old")["commit"], "b")
        for name in ("old.md", "unit-costs.json"):
            self.assertEqual((self.root / "experiments/record/old" / name).read_text(), name)
        self.assertIn("unit-costs.json is the old one", done.stderr)

    def test_no_time_and_no_clean_program(self):
        self.hold("old")
        self.assertIn("old (no time)", self.make("--hours", "-1").stderr)
        self.program_of("c", changes=True)
        self.assertEqual(self.make().returncode, 2)
        self.assertEqual(self.make("--only", "unknown").returncode, 2)
        self.assertEqual(self.machine("old")["commit"], "a")


if __name__ == "__main__":
    unittest.main()
