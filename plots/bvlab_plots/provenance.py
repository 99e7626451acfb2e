# SPDX-License-Identifier: BSD-3-Clause
"""Which program made a record: the commit that machine.json names, and whether the history has it."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from bvlab_plots.refused import Refused

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Made:
    """Where a record is from; "" is what it does not say, and None."""
    version: str
    commit: str
    date: str
    changes: bool | None
    merged_as: str = ""  # the commit in which that one was merged, where its own history was not kept


def machine_of(record):
    """machine.json as a dictionary, empty where there is none."""
    path = Path(record) / "machine.json"
    try:
        return json.loads(path.read_text()) if path.is_file() else {}
    except ValueError as fault:
        raise Refused(f"{path}: {fault}") from None


def made(machine):
    """Older records have "0.1.0 <commit> with changes" in one."""
    version, _, rest = str(machine.get("bvlab", "")).partition(" ")
    if "commit" in machine:
        return Made(version, machine["commit"] or "", machine.get("date", ""), machine.get("changes"), machine.get("merged_as", ""))
    commit, _, more = rest.partition(" ")
    return Made(version, commit, "", bool(more) if commit else None)


def git(*words, root=ROOT):
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
    by = made(machine_of(record))
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


def processor_of(machine):
    """The processor's name as pages say it."""
    return machine["processor"].replace("(R)", "").removesuffix(" Processor")
