#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What cells of the engine count and answer is what the tables beside this file say, as text.

usage: golden_test.py [PROGRAM] [--write]

PROGRAM is golden_table, by default that of build/release. A line holds the labels of a cell, "hits hash" of its answers,
and "n_u n_v n_p" of each strategy or candidate. Names what differs, and sums up N_v by column. Cells whose volume
or strategy was not compiled, or whose meshes are not in build/, are passed over; counts are compared where
registers have as many lanes as the table was written with. A line is there if it has a count: refused are "-" (a cell that
becomes allowed differs, a line that does is not in the table). --write replaces the tables, but for what is passed over: a
change that means to alter counts commits what it rewrites, and its diff says of which cells. coherence.csv and the lines
"2 world" to "16 body" of cells.csv are of the gathered kernel, all else of siblings and mixed.
"""

import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PROGRAM = ROOT / "build" / "release" / "tests" / "golden" / "golden_table"
DEFINITIONS = ROOT / "experiments" / "definitions"
# Each table's frames, and the values of axes that are taken. They are few, so that the tables stay below 150 kB and the test
# takes less than a minute: all of kernel, volume, strategy and query, but not every mesh and motion. coherence is without three
# shapes, six motions and what one body does; of recommended-costs there is the bunny of 500 triangles alone: no public scenes,
# and nothing of 2000 or 8000 triangles.
TABLES = {HERE / "cells.toml": ["8"],
          DEFINITIONS / "coherence.toml": ["12", "mesh=bunny;knot;star", "motion=0.001 / 0.1;0.03 / 5;0 / 10",
                                           "motion_model=all bodies, all freedoms;all bodies, persisting"],
          HERE / "recommended-costs.toml": ["8", "motion=" + ";".join(
              f"bunny of 500, {motion}" for motion in ("5 degrees", "planner", "graze", "near", "slow", "5 degrees, contacts",
                                                       "near, contacts", "slow, contacts"))]}
MOST_NAMED = 40


def read(text):
    """(lanes, names of the columns, {labels of a line: its fields}) of a table."""
    lanes, head, *lines = text.splitlines()
    head = head.split(";")
    labels = head.index("hits answers")
    rows = {}
    for line in lines:
        fields = line.split(";")
        rows[";".join(fields[:labels])] = dict(zip(head[labels:], fields[labels:], strict=True))
    return lanes, head, rows


def counts_something(row):
    """Whether one of its cells is neither refused nor passed over."""
    return any(value not in ("", "-") for value in row.values())


def differences(golden, fresh):
    """Lines that say what differs."""
    (lanes, head, expected), (own_lanes, own_head, found) = golden, fresh
    if head != own_head:
        return [f"the columns are {head}, now {own_head}"]
    said = [f"{labels}: in the table, and now no more" for labels in expected.keys() - found.keys()]
    said += [f"{labels}: not in the table" for labels, row in found.items() if labels not in expected and counts_something(row)]
    sums = {}
    for labels in expected.keys() & found.keys():
        for column, now in found[labels].items():
            before = expected[labels][column]
            if now in ("", before) or (column != "hits answers" and lanes != own_lanes):
                continue
            said.append(f"{labels}: {column}: {before}, now {now}")
            if len(before.split()) == len(now.split()) == 3:
                total = sums.setdefault(column, [0, 0, 0])
                for k, add in enumerate((1, int(before.split()[1]), int(now.split()[1]))):
                    total[k] += add
    return sorted(said) + [f"{column}: {cells} cells differ; N_v of these {before}, now {now} ({100 * (now / max(before, 1) - 1):+.2f} %)"
                   for column, (cells, before, now) in sums.items()]


def main():
    words = [word for word in sys.argv[1:] if word != "--write"]
    program = words[0] if words else os.environ.get("BVLAB_GOLDEN_TABLE", PROGRAM)
    failed = False
    for definition, choices in TABLES.items():
        table = HERE / f"{definition.stem}.csv"
        text = subprocess.run([program, definition, *choices], stdout=subprocess.PIPE, text=True, check=True).stdout
        fresh = read(text)
        if "--write" in sys.argv:
            lanes, head, rows = fresh
            known = read(table.read_text(encoding="utf-8"))[2] if table.exists() else {}
            rows = {labels: {column: now or known.get(labels, {}).get(column, "") for column, now in row.items()}
                    for labels, row in rows.items()}
            lines = [";".join([labels, *row.values()]) for labels, row in rows.items() if counts_something(row)]
            table.write_text("\n".join([lanes, ";".join(head), *lines]) + "\n", encoding="utf-8")
            continue
        golden = read(table.read_text(encoding="utf-8"))
        said = differences(golden, fresh)
        compared = sum(map(counts_something, fresh[2].values()))
        print(f"{table.name}: {compared} of {len(golden[2])} lines are compared; {len(said)} differences", flush=True)
        for line in said[:MOST_NAMED] + said[max(MOST_NAMED, len(said) - 9):]:
            print(f"  {line}")
        if golden[0] != fresh[0]:
            print(f"  answers alone: the table is of {golden[0][2:]}, this program has {fresh[0][2:]}")
        failed |= bool(said)
    sys.exit(failed)


if __name__ == "__main__":
    main()
