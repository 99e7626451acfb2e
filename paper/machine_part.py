# SPDX-License-Identifier: BSD-3-Clause
"""Where the records were made, and of which commits."""

import json

from sheet import escape, listed


def write_machine(paper):
    machines = [json.loads(path.read_text()) for path in sorted(paper.records.glob("*/machine.json"))]
    of = {
        key: sorted({str(m.get(key, "")).replace("(R)", "") for m in machines})
        for key in ("processor", "cores", "compiler", "libraries")
    }
    commits = [str(m.get("bvlab", "")).split()[1:] for m in machines]
    changed = sum("changes" in commit for commit in commits)
    unnamed = sum(not commit for commit in commits)
    paper.put_text(
        recordsCount=len(machines),
        recordsProcessor=listed(map(escape, of["processor"])),
        recordsCores=listed(of["cores"]),
        recordsCompiler=listed(map(escape, of["compiler"])),
        recordsLibraries=escape("; ".join(of["libraries"])),
    )
    faults = [
        f"{count} {what}"
        for count, what in ((changed, "are of a tree with changes"), (unnamed, "name no commit"))
        if count
    ]
    paper.numbers["recordsFaults"] = (
        f"Of the {len(machines)} records {' and '.join(faults)}."
        if faults
        else "Every record names the commit that it was made from."
    )
