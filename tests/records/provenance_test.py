# SPDX-License-Identifier: BSD-3-Clause
"""Every record of the repository was made from a commit that is in the history, without changes."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

from repository import RECORDS, ROOT, skip

from bvlab_plots import provenance

NOBODY = ["-c", "user.name=nobody", "-c", "user.email=nobody@example.org", "-c", "commit.gpgsign=false"]


def git(*words, root):
    # Whoever owns the folder: a container is not asked.
    return subprocess.run(["git", "-c", "safe.directory=*", "-C", root, *words], capture_output=True, text=True, check=False)


def history(root=ROOT):
    """Why the history cannot be asked, "" where it can."""
    try:
        shallow = git("rev-parse", "--is-shallow-repository", root=root)
    except FileNotFoundError:
        return "git is not installed"
    if shallow.returncode or git("rev-parse", "--show-toplevel", root=root).stdout.strip() != str(Path(root).resolve()):
        return "this is no checkout"
    return "the checkout is shallow" if shallow.stdout.strip() == "true" else ""


def fault_of(record, root=ROOT):
    """Why a record could not be made again from the history, "" where it could."""
    by = provenance.made(provenance.machine_of(record))
    if not by.commit:
        return "names no commit"
    if by.changes:
        return f"was made from {by.commit[:12]} with changes"
    if by.changes is None:
        return f"does not say whether {by.commit[:12]} had changes"
    kept = by.merged_as or by.commit
    if git("merge-base", "--is-ancestor", kept, "HEAD", root=root).returncode:
        return f"was made from {kept[:12]}, which is not in the history"
    return ""


class Provenance(unittest.TestCase):
    def test_every_record_is_from_the_history(self):
        for record in RECORDS:
            with self.subTest(record.name):
                self.assertEqual(fault_of(record, ROOT), "")


class Faults(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = Path(temporary.name)
        self.git("init", "-q")
        self.git("commit", "-q", "--allow-empty", "-m", "first")
        self.commit = self.git("rev-parse", "HEAD")

    def git(self, *words):
        return subprocess.run(["git", *NOBODY, "-C", self.root, *words], check=True, capture_output=True, text=True).stdout.strip()

    def fault(self, **machine):
        (self.root / "machine.json").write_text(json.dumps(machine))
        return fault_of(self.root, self.root)

    def test_a_commit_of_the_history(self):
        self.assertEqual(history(self.root), "")
        self.assertEqual(self.fault(bvlab="0.1.0", commit=self.commit, changes=False), "")
        self.assertEqual(self.fault(bvlab=f"0.1.0 {self.commit[:7]}"), "")
        self.assertEqual(self.fault(bvlab="0.1.0", commit="0" * 40, changes=False, merged_as=self.commit), "")
        self.assertIn("not in the history", self.fault(bvlab="0.1.0", commit=self.commit, changes=False, merged_as="0" * 40))

    def test_none_changed_or_lost(self):
        self.assertIn("no commit", self.fault(bvlab="0.1.0 "))
        self.assertIn("no commit", self.fault(bvlab="0.1.0", commit=None, changes=None))
        self.assertIn("with changes", self.fault(bvlab=f"0.1.0 {self.commit[:7]} with changes"))
        self.assertIn("with changes", self.fault(bvlab="0.1.0", commit=self.commit, changes=True))
        self.assertIn("does not say", self.fault(bvlab="0.1.0", commit=self.commit, changes=None))
        self.assertIn("not in the history", self.fault(bvlab="0.1.0", commit="0" * 40, changes=False))
        self.git("checkout", "-q", "--orphan", "other")
        self.git("commit", "-q", "--allow-empty", "-m", "other")
        self.assertIn("not in the history", self.fault(bvlab="0.1.0", commit=self.commit, changes=False))

    def test_where_there_is_no_history(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(history(Path(folder)), "this is no checkout")
            self.git("commit", "-q", "--allow-empty", "-m", "second")
            subprocess.run(["git", "clone", "-q", "--depth", "1", f"file://{self.root}", f"{folder}/shallow"], check=True)
            self.assertEqual(history(Path(folder) / "shallow"), "the checkout is shallow")


if __name__ == "__main__":
    if why := history(ROOT):
        skip(f"records are not held against the history: {why}")
    unittest.main()
