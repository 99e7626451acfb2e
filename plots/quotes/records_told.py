# SPDX-License-Identifier: BSD-3-Clause
"""All records together: how many, on what machine, and how many of their times were measured alone."""

import pandas as pd

from bvlab_plots import provenance
from bvlab_plots.records import table_at
from quoting import ALL, claim, quotes
from bvlab_plots.refused import Refused


@quotes(ALL)
def all_records(folder):
    names = sorted(path.parent.name for path in folder.glob("*/definition.toml"))
    if not names:
        raise Refused(f"{folder}: there are no records")
    machines = [provenance.machine_of(folder / name) for name in names]
    alone = timed = 0
    longest, shared, peers_of = 0, [], {}
    for name in names:
        rows = pd.read_csv(table_at(folder / name / f"{name}.csv"), usecols=lambda column: column in ("alone", "wall_per_processor", "peer"))
        peers_of[name] = set(rows.peer) if "peer" in rows else set()
        if "wall_per_processor" in rows:
            longest = max(longest, pd.to_numeric(rows.wall_per_processor, errors="coerce").max())
        if "alone" in rows:
            timed, alone = timed + rows.alone.notna().sum(), alone + (rows.alone == "yes").sum()
            if (rows.alone == "no").any():
                shared.append(name)
    processors = pd.Series([provenance.processor_of(machine) for machine in machines]).value_counts()
    claim({str(machine["cores"]) for machine in machines} == {"2"}, "machines of two cores")
    made = [provenance.made(machine) for machine in machines]
    claim(all(by.commit and not by.changes for by in made), "every record names its commit, without changes")
    claim(shared == ["end-to-end", "real-motions"], "all rows but some of end-to-end and of real-motions were timed alone")
    claim(longest <= 1.1, "no run lost more than a tenth to other work")
    by_processor = {name for name, machine in zip(names, machines) if machine.get("clock", "wall") != "wall"}
    claim(not by_processor, "times are by the wall clock")
    undated = [name for name, by in zip(names, made) if not by.date]
    claim(not undated, "every record has a date")
    claim(len({machine["compiler"] for machine in machines}) == 1, "one compiler")
    changing = pd.read_csv(folder / "boxes-changes" / "boxes-changes.csv", usecols=["method"]).method
    claim({"jolt", "physx-abp", "physx-pabp", "physx-sap"} <= set(changing), "PhysX and Jolt are in the record of changing boxes")
    physx, coal = ({name for name in names if peers_of[name] & peers} for peers in ({"physx"}, {"coal-obb", "coal-obbrss", "coal-rss"}))
    claim(physx == {"tournament-peers", "peers-meshes", "real-motions", "end-to-end"}, "PhysX is in four records of the narrow phase, and in the stability map")
    claim(coal - physx == {"distances"}, "Coal is in one record more")
    return {"count": len(names), "processors": [f"{name} ({count})" for name, count in processors.items()], "timed": timed, "shared": timed - alone}
