# SPDX-License-Identifier: BSD-3-Clause
"""Every record of the repository was made from a commit that is in the history, without changes."""

import importlib.machinery
import importlib.util
import json
import re
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


def records_command():
    """experiments/records, as a module."""
    loader = importlib.machinery.SourceFileLoader("records_command", str(ROOT / "experiments" / "records"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class Provenance(unittest.TestCase):
    def test_the_page_names_the_records_of_an_older_engine(self):
        head = git("rev-parse", "HEAD", root=ROOT).stdout.strip()
        command = records_command()
        due = {record.name for record in RECORDS if command.is_due(record.name, head)}
        said = re.search(r"^- Of an older engine than this one (?:is|are) (.*)$", (ROOT / "experiments" / "results.md").read_text(), re.M)
        named = set(re.findall(r"\(record/([^)]*)\)", said[1])) if said else set()
        self.assertEqual(due, due if said and said[1].startswith("all") else named)

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
