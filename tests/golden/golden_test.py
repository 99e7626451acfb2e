#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What cells of the engine count and answer is what the tables beside this file say, as text.

usage: golden_test.py [PROGRAM] [--write]

PROGRAM is golden_table, by default that of build/release. A line holds the labels of a cell, "hits hash" of its answers,
and "n_u n_v n_p" of each strategy or candidate. Names what differs, and sums up N_v by column. Cells whose volume
or strategy was not compiled, or whose meshes are not in build/, are passed over; counts are compared where
registers have as many lanes as the table was written with. --write replaces the tables, but for what is passed over.
"""

import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PROGRAM = ROOT / "build" / "release" / "tests" / "golden" / "golden_table"
# Frames of each cell: few, since a cell of slow motion has a sister of fast motion.
TABLES = {ROOT / "experiments" / "definitions" / "coherence.toml": 24,
          ROOT / "experiments" / "definitions" / "recommended-costs.toml": 12,
          HERE / "cells.toml": 16}
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


def differences(golden, fresh):
    """Lines that say what differs."""
    (lanes, head, expected), (own_lanes, own_head, found) = golden, fresh
    if head != own_head or expected.keys() != found.keys():
        return [f"not in the table, or in it alone: {each}" for each in sorted({*head, *expected} ^ {*own_head, *found})]
    said, sums = [], {}
    for labels, row in found.items():
        for column, now in row.items():
            before = expected[labels][column]
            if now in ("", before) or (column != "hits answers" and lanes != own_lanes):
                continue
            said.append(f"{labels}: {column}: {before}, now {now}")
            if len(before.split()) == len(now.split()) == 3:
                total = sums.setdefault(column, [0, 0, 0])
                for k, add in enumerate((1, int(before.split()[1]), int(now.split()[1]))):
                    total[k] += add
    return said + [f"{column}: {cells} cells differ; N_v of these {before}, now {now} ({100 * (now / max(before, 1) - 1):+.2f} %)"
                   for column, (cells, before, now) in sums.items()]


def main():
    words = [word for word in sys.argv[1:] if word != "--write"]
    program = words[0] if words else os.environ.get("BVLAB_GOLDEN_TABLE", PROGRAM)
    failed = False
    for definition, frames in TABLES.items():
        table = HERE / f"{definition.stem}.csv"
        text = subprocess.run([program, definition, str(frames)], stdout=subprocess.PIPE, text=True, check=True).stdout
        fresh = read(text)
        if "--write" in sys.argv:
            lanes, head, rows = fresh
            known = read(table.read_text(encoding="utf-8"))[2] if table.exists() else {}
            lines = [";".join([labels, *(now or known.get(labels, {}).get(column, "") for column, now in row.items())])
                     for labels, row in rows.items()]
            table.write_text("\n".join([lanes, ";".join(head), *lines]) + "\n", encoding="utf-8")
            continue
        golden = read(table.read_text(encoding="utf-8"))
        said = differences(golden, fresh)
        compared = sum(any(row.values()) for row in fresh[2].values())
        print(f"{table.name}: {compared} of {len(golden[2])} lines are compared; {len(said)} differences", flush=True)
        for line in said[:MOST_NAMED] + said[max(MOST_NAMED, len(said) - 9):]:
            print(f"  {line}")
        if golden[0] != fresh[0]:
            print(f"  answers alone: the table is of {golden[0][2:]}, this program has {fresh[0][2:]}")
        failed |= bool(said)
    sys.exit(failed)


if __name__ == "__main__":
    main()
