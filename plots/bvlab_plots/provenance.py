# SPDX-License-Identifier: BSD-3-Clause
"""Which program made a record, and on what machine, by its machine.json."""

import json
from dataclasses import dataclass
from pathlib import Path

from bvlab_plots.refused import Refused


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


def processor_of(machine):
    """The processor's name as pages say it."""
    return machine["processor"].replace("(R)", "").removesuffix(" Processor")
