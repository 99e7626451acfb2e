# SPDX-License-Identifier: BSD-3-Clause
"""A sweep on a Slurm of one node: its record is the local one, although daemons and jobs are killed in its midst."""

import os
import platform
import shutil
import signal
import subprocess
import time
import unittest

import one_node
from sweeping import PARTS, ROOT, SweepTest, skip


class Slurm(SweepTest):
    def setUp(self):
        super().setUp()
        try:
            self.slurm = one_node.OneNode()
            self.slurm.__enter__()
        except TimeoutError as fault:
            self.skipTest(f"Slurm does not start here: {fault}")
        self.addCleanup(self.slurm.__exit__)

    def command(self, *more):
        # Submitted jobs inherit it, too.
        return ["env", f"SLURM_CONF={self.slurm.environment['SLURM_CONF']}", *super().command("--slurm", *more)]

    def running(self):
        """Numbers and names of the jobs at work."""
        return [line.split() for line in self.slurm.ask("squeue", "--noheader", "--states=R", "--format=%A %j").splitlines()]

    def kill_a_part(self):
        """The processes of a job that is in the midst of a part."""
        begun, ended = self.diary("begins"), {part for part, _ in self.diary("ends")}
        part = next(part for part, _ in reversed(begun) if part not in ended)
        found = subprocess.run(["pgrep", "-f", f"{self.folder}.*--part {part}/"], capture_output=True, text=True)
        for number in found.stdout.split():
            os.kill(int(number), signal.SIGKILL)
        self.assertTrue(found.stdout)

    def test_daemons_and_jobs_are_killed(self):
        self.run_whole("--counts")
        (self.folder / "lasts").write_text("15")
        process = self.begin("--counts", "--jobs", 2)
        self.wait_for(lambda: len(self.diary("begins")) >= 2)
        # It saves what it knows after 5 seconds, and gives out the same numbers again for jobs that it has lost.
        time.sleep(7)
        self.slurm.kill("slurmctld")  # the controller, with jobs at work, which end while it is away
        (self.folder / "lasts").write_text("4")
        self.wait_for(lambda: len(self.diary("ends")) >= 2)
        self.slurm.start_controller()
        self.wait_for(lambda: len(self.diary("begins")) >= 3)
        self.kill_a_part()
        self.wait_for(lambda: self.running() and len(self.diary("begins")) >= 4)
        self.slurm.ask("scancel", "--signal=KILL", "--full", self.running()[0][0])
        self.slurm.kill("slurmd")  # the node's daemon
        time.sleep(2)
        self.slurm.start_node()
        said = process.communicate(timeout=600)
        self.assertEqual((process.returncode, *said), (0, "swept\n", ""), self.slurm.last_words())
        self.assert_same_record(timed=False)
        self.assertGreater(len(self.diary("begins")), PARTS)  # something was lost, and tried again

    def test_the_sweep_itself_is_killed(self):
        self.run_whole("--counts")
        (self.folder / "lasts").write_text("3")
        process = self.begin("--counts", "--jobs", 2)
        self.wait_for(lambda: len(self.finished()) >= 1)
        self.kill(process)
        # Its jobs are still in Slurm's hands; those of the next sweep wait for them.
        (self.folder / "lasts").write_text("0")
        self.sweep("--counts", "--jobs", 2)
        self.assert_same_record(timed=False)

    def test_timed_parts_have_the_node_to_themselves(self):
        self.run_whole()
        # A profile of one's own, with a blank in its path.
        profile = self.folder / "my profile"
        shutil.copytree(ROOT / "experiments/workflow/slurm", profile)
        self.sweep("--jobs", 3, "--profile", profile)
        self.assert_same_record(timed=True)
        self.assertEqual({row["node"] for row in self.rows("swept")}, {platform.node()})
        moments = sorted([(time, 1) for _, time in self.diary("begins")] + [(time, -1) for _, time in self.diary("ends")])
        beside = 0
        for _, change in moments:
            beside += change
            self.assertLessEqual(beside, 1)


if __name__ == "__main__":
    if one_node.missing():
        groups = 'source "$1"; set_up_packages sweep slurm'
        subprocess.run(["bash", "-c", groups, "bash", ROOT / "experiments/setup"], check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if one_node.missing():
        skip(f"{', '.join(one_node.missing())} cannot be installed here")
    unittest.main()
