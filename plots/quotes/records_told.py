# SPDX-License-Identifier: BSD-3-Clause
"""All records together: how many, on what machine, and how many of their times were measured alone."""

import json

import pandas as pd

from bvlab_plots import provenance
from quoting import ALL, claim, quotes
from bvlab_plots.refused import Refused


@quotes(ALL)
def all_records(folder):
    names = sorted(path.parent.name for path in folder.glob("*/definition.toml"))
    if not names:
        raise Refused(f"{folder}: there are no records")
    machines = [json.loads((folder / name / "machine.json").read_text()) for name in names]
    alone = timed = 0
    for name in names:
        rows = pd.read_csv(folder / name / f"{name}.csv", usecols=lambda column: column == "alone")
        if "alone" in rows:
            timed, alone = timed + rows.alone.notna().sum(), alone + (rows.alone == "yes").sum()
    processors = pd.Series([machine["processor"].replace("(R)", "").removesuffix(" Processor") for machine in machines]).value_counts()
    claim({str(machine["cores"]) for machine in machines} == {"2"}, "machines of two cores")
    made = [provenance.made(machine) for machine in machines]
    claim(all(by.commit and not by.changes for by in made), "every record names its commit, without changes")
    claim(len({machine["compiler"] for machine in machines}) == 1, "one compiler")
    return {"count": len(names), "processors": [f"{name} ({count})" for name, count in processors.items()], "timed": timed, "alone": 100 * alone / timed}
