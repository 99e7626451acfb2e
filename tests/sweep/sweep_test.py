# SPDX-License-Identifier: BSD-3-Clause
"""A sweep here: its record is that of `bvlab run`, also after it was killed and when parts fail."""

import platform
import shutil
import signal
import subprocess
import time
import unittest

from sweeping import BVLAB, PARTS, SweepTest, skip


class Sweeps(SweepTest):
    def test_counts_are_those_of_one_run(self):
        self.run_whole("--counts")
        self.sweep("--counts", "--jobs", 3)
        self.assert_same_record(timed=False)
        tables = [(self.folder / record / "small.csv").read_bytes() for record in ("whole", "swept")]
        self.assertEqual(*tables)
        self.assertEqual({row["time_ns"] for row in self.rows("swept")}, {""})
        # And nothing is run again.
        before = len(self.diary("begins"))
        self.sweep("--counts")
        self.assertEqual(len(self.diary("begins")), before)

    def test_timed_parts_run_one_at_a_time(self):
        self.run_whole()
        self.sweep()
        self.assert_same_record(timed=True)
        for begun, ended in zip(sorted(self.diary("begins"), key=lambda x: x[1])[1:], self.diary("ends")):
            self.assertGreater(begun[1], ended[1])
        for row in self.rows("swept"):
            self.assertGreater(int(row["time_ns"]), 0)
            self.assertEqual(row["node"], platform.node())
            self.assertIn(row["alone"], ["yes", "no"])

    def test_goes_on_where_it_was_killed(self):
        self.run_whole("--counts")
        (self.folder / "lasts").write_text("0.5")
        process = self.begin("--counts", "--jobs", 2)
        self.wait_for(lambda: len(self.finished()) >= 2)
        self.kill(process)
        finished = self.finished()
        self.assertGreaterEqual(len(finished), 2)
        self.assertLess(len(finished), PARTS)
        self.assertFalse((self.folder / "swept" / "small.csv").exists())
        (self.folder / "lasts").write_text("0")
        before = len(self.diary("begins"))
        self.sweep("--counts", "--jobs", 2)
        self.assert_same_record(timed=False)
        again = {part for part, _ in self.diary("begins")[before:]}
        self.assertEqual(again, set(range(1, PARTS + 1)) - set(finished))

    def alive(self):
        """The processes that work on the record."""
        found = subprocess.run(["pgrep", "-f", f"{self.folder}/swept/parts"], capture_output=True, text=True)
        return found.stdout.split()

    def test_killed_alone_it_leaves_nobody_behind(self):
        (self.folder / "lasts").write_text("100")
        process = self.begin("--counts", "--jobs", 2)
        self.wait_for(lambda: len(self.diary("begins")) >= 2)
        self.assertTrue(self.alive())
        process.kill()
        process.communicate()
        end = time.monotonic() + 20
        while self.alive() and time.monotonic() < end:
            time.sleep(0.1)
        self.assertEqual(self.alive(), [])

    def test_who_is_at_work_is_named(self):
        (self.folder / "lasts").write_text("100")
        process = self.begin("--counts", "--jobs", 2)
        self.wait_for(lambda: len(self.diary("begins")) >= 2)
        done = subprocess.run(self.command("--counts"), cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, rf"another sweep is at work on it: .*process {process.pid} \(")
        self.kill(process)

    def test_every_table_is_merged(self):
        """Predictions were lost: the merge had a list of its own."""
        definition = self.folder / "small.toml"
        definition.write_text(definition.read_text().replace('["coherence"]', '["coherence", "predictions"]'))
        self.run_whole("--counts")
        self.sweep("--counts", "--jobs", 2)
        self.assert_same_record(timed=False)
        tables = [(self.folder / record / "small.predictions.csv").read_bytes() for record in ("whole", "swept")]
        self.assertEqual(*tables)

    def test_names_and_marks(self):
        """A carriage return in a name, and a mark of the byte order before the definition."""
        definition = self.folder / "small.toml"
        text = definition.read_text().replace("dense, of course", "dense\\rof course")
        definition.write_bytes(b"\xef\xbb\xbf" + text.encode())
        self.run_whole("--counts")
        self.sweep("--counts", "--jobs", 2)
        self.assert_same_record(timed=False)
        self.assertEqual({row["density"] for row in self.rows("swept")}, {"dense\rof course", '"sparse"'})
        self.sweep("--counts")  # finished, and seen to be

    def test_a_spoiled_plan(self):
        """What is no plan is named, in one line, and stays."""
        plan = self.folder / "swept" / "parts" / "plan.json"
        plan.parent.mkdir(parents=True)
        for spoiled in ("{", "[]", '{"measured": "counts"}', '{"measured": "counts", "parts": "many"}'):
            plan.write_text(spoiled)
            done = subprocess.run(self.command("--counts"), cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), (spoiled, done.stderr))
            self.assertIn("plan.json: is no plan of a sweep", done.stderr)
            self.assertEqual(plan.read_text(), spoiled)

    def test_what_fails_is_tried_again(self):
        self.run_whole("--counts")
        (self.folder / "fails-3").touch()
        self.sweep("--counts", "--jobs", 2)
        self.assert_same_record(timed=False)
        self.assertEqual([part for part, _ in self.diary("begins")].count(3), 2)

    def test_interrupted(self):
        (self.folder / "lasts").write_text("20")
        process = self.begin("--counts", "--jobs", 2)
        self.wait_for(lambda: len(self.diary("begins")) >= 2)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=60)
        self.assertEqual((process.returncode, *said), (1, "", "sweep: interrupted; the same command goes on\n"))

    def refuse(self, *words, mentions):
        done = subprocess.run(list(map(str, words)), cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertRegex(done.stderr, r"\A(sweep|bvlab): [^\n]+\n\Z")
        self.assertIn(mentions, done.stderr)
        self.assertFalse((self.folder / "swept").exists())

    def test_refusals(self):
        sweep = self.command()[0]
        self.refuse(sweep, mentions="definition")
        self.refuse(sweep, "absent.toml", "--record", "swept", "--bvlab", BVLAB, mentions="absent.toml")
        self.refuse(*self.command("--jobs", "0"), mentions="0")
        given = [sweep, "small.toml", "--record", "swept", "--bvlab"]
        for program, said in (("small.toml", "is no program"), (".", "is no program"), ("/bin/true", "is it bvlab?"),
                              ("/bin/false", "is it bvlab?")):
            self.refuse(*given, program, mentions=said)
        (self.folder / "a-file").touch()
        self.refuse(sweep, "small.toml", "--record", "a-file", "--bvlab", BVLAB, mentions="cannot be made")
        (self.folder / "bad.toml").write_text('name = "bad"\nnonsense = 1\n')
        self.refuse(sweep, "bad.toml", "--record", "swept", "--bvlab", BVLAB, mentions="line 2")
        (self.folder / "study.toml").write_text('name = "s"\nkind = "triangles"\n')
        self.refuse(sweep, "study.toml", "--record", "swept", "--bvlab", BVLAB, mentions="study.toml")

    def test_parts_that_are_refused(self):
        for part in ("0/2", "3/2", "1/9", "1", "1/", "1/2x", "-1/2"):
            self.refuse(BVLAB, "run", "small.toml", "--record", "swept", "--part", part, mentions="K/N is needed")
        (self.folder / "study.toml").write_text('name = "s"\nkind = "triangles"\n')
        self.refuse(BVLAB, "run", "study.toml", "--record", "swept", "--counts", mentions="a study measures what its kind says")

    def test_counts_and_times_are_not_mixed(self):
        self.run_whole("--counts")
        before = (self.folder / "whole" / "small.csv").read_bytes()
        self.refuse(BVLAB, "run", "small.toml", "--record", "whole", mentions="holds counts alone")
        self.assertEqual((self.folder / "whole" / "small.csv").read_bytes(), before)

    def test_a_record_from_before_nodes_were_named_goes_on(self):
        self.run_whole()
        table = self.folder / "whole" / "small.csv"
        whole = table.read_text().splitlines()
        names = whole[0].split(",")
        lines = [line.rsplit(",", len(names) - names.index("node"))[0] for line in whole]
        table.write_text("\n".join(lines[:17]) + "\n")  # the first two traces
        self.run_whole()
        rows = self.rows("whole")
        self.assertEqual([row["node"] for row in rows], [""] * 16 + [platform.node()] * (len(rows) - 16))
        self.assertEqual(len(rows), 4 * 2 * 4 * 2)

    def test_another_definition_is_refused(self):
        self.run_whole("--counts")
        (self.folder / "other.toml").write_text((self.folder / "small.toml").read_text() + "until = 9\n")
        self.refuse(self.command()[0], "other.toml", "--record", "whole", "--counts", "--bvlab", BVLAB,
                    mentions="another definition")


if __name__ == "__main__":
    if not shutil.which("snakemake"):
        skip("there is no snakemake")
    unittest.main()
