# SPDX-License-Identifier: BSD-3-Clause
"""Every script of plots/ that computes something draws records in which a volume, a strategy, a peer and others have
never been heard of: nothing fails, nothing is missing in silence, and no stranger looks like its neighbour."""

import importlib
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from drawing import PLOTS, Seen
from small_records import STRATEGIES, names_added, own_record, small_record, stranger

RECURSIVE = dict(strategy="recursive")
# Script: the record it draws, how much of it, and the strangers added, each like a name that is there.
SPECS = {
    "coherence": ("coherence", dict(mesh=2, motion=2, motion_model=1), dict(volume="obb", strategy=("deferred", STRATEGIES)),
                  RECURSIVE),
    "cost_model": ("cost-model", dict(volume=3), dict(volume="sphere", strategy="deferred", density="dense"),
                   RECURSIVE),
    "nine_bunnies": ("nine-bunnies", dict(seed=2, reading=2),
                     dict(variant=("deferred", STRATEGIES), reading="one body, one freedom", density="dense"), None),
    "stability_map": ("stability-map", dict(level=4), dict(volume="sphere", precision="float32", source="fcl-obb",
                                                           stressor="offset"), None),
    "triangles_error": ("triangles-error", dict(set=2), dict(test="moller", set="random"), None),
}
BY_THEMSELVES = {"fronts"}  # has a test of its own, which says otherwise what is no record of its own
# Drawn together with others, without a name of their own; or on one line with all that are the same.
POOLED = {"cost_model": ["strategy"], "stability_map": ["volume"]}


class Scripts(unittest.TestCase):
    def test_every_script(self):
        scripts = {path.stem for path in (PLOTS / "bvlab_scripts").glob("*.py") if "def main(" in path.read_text()} - BY_THEMSELVES
        self.assertEqual(scripts, set(SPECS), "a script that is not tested, or is no more")
        for script, (name, keep, strangers, peer_like) in SPECS.items():
            with self.subTest(script), tempfile.TemporaryDirectory() as folder:
                record = small_record(name, Path(folder) / "record", keep, strangers, peer_like)
                with mock.patch.object(sys, "argv", [f"{script}.py", str(record), "--out", folder]):
                    seen = Seen(self, importlib.import_module(f"bvlab_scripts.{script}").main)
                self.assertTrue(seen.paths)
                pooled = [stranger(column) for column in POOLED.get(script, [])]
                seen.check(self, [n for n in names_added(strangers, peer_like) if n not in pooled])

    def test_what_is_no_record_of_theirs(self):
        with tempfile.TemporaryDirectory() as folder:
            other = own_record(folder)
            for script in sorted(SPECS):
                for record, mention in ((other, "has"), (Path(folder) / "none", "no record")):
                    name = script.replace("_", "-")
                    done = subprocess.run([PLOTS / "script", name, record], capture_output=True, text=True)
                    with self.subTest(script=script, record=record):
                        self.assertEqual(done.returncode, 2, done.stderr)
                        self.assertRegex(done.stderr, rf"\A{name}: {record}: [^\n]*{mention}[^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
