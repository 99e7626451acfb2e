# SPDX-License-Identifier: BSD-3-Clause
"""The board: every library and ours on every scene, time against wrong answers.

usage: plots/board RECORD ... [--out FILE.csv]

A row for each side and scene of a record in which other libraries stand beside ours: time of a pair in the steady state,
its slowest frame in a hundred, time to build, answers that differ from the exact ones (in a thousand pairs), how many
times the fastest of its scene it takes, how it is configured and who chose that (for a library: the table in its
folder's README.md). Medians over repetitions, then means over seeds. A side whose answers differ stays in, with their
number. Memory stands where a record has it (column `bytes`).
"""

import argparse
import html
import re
from pathlib import Path

import pandas as pd

from bvlab_plots import records

PEERS = Path(__file__).resolve().parents[2] / "experiments" / "peers"
NEEDED = {"peer", "later_ns", "later_pairs", "differing", "build_ns"}
# What tells sides of a scene apart, and what is averaged over.
SIDE = {"method", "variant", "peer", "configuration", "volume", "strategy", "tree", "fan_out", "frame", "kernel", "build",
        "fit", "leaf_size", "precision", "relative_error", "program"}
DRAWN = {"seed", "repetition"}
COLUMNS = {"scene": "", "side": "", "us": "us per pair", "times": "times the fastest", "wrong": "wrong of 1000", "p99_us": "p99, us per pair",
           "build_ms": "build, ms", "memory_mb": "memory, MB", "configuration": "", "chosen_by": "chosen by"}
ROW = re.compile(r"^\| *(.+?) *\| *(.+?) *\| *(.+?) *\|$")


def settings_of_peers(folder=PEERS):
    """By name: (settings, who chose them), out of the tables of the folders' pages."""
    said = {}
    for page in sorted(folder.glob("*/README.md")):
        for line in page.read_text().splitlines():
            # A line of a table may go on in the next one.
            if not (row := ROW.match(line)) or set(row[1]) <= set("-") or row[1] == "name" or row[1].startswith("boxes"):
                continue
            for name in re.findall(r"`([^`]+)`", row[1]):
                said[name] = row[2], row[3]
    return said


def of_record(rows, said):
    """The board's rows of one record; none where it has no peers or no times."""
    if not set(rows) >= NEEDED or not (rows.peer != "").any() or rows.later_ns.isna().all():
        return pd.DataFrame(columns=list(COLUMNS))
    records.wrong_answers(rows)  # of ours none may be
    place = [c for c in rows.attrs["settings"] if c not in SIDE | DRAWN and rows[c].nunique() > 1]
    # Columns that a label implies say nothing more.
    place = [c for i, c in enumerate(place) if not any(rows.groupby(label, dropna=False)[c].nunique(dropna=False).max() == 1
                                                       for label in place[:i])]
    side = "method" if "method" in rows else "variant"
    keys = [*place, side, *(["program"] if "program" in rows else [])]
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, wrong=1e3 * rows.differing / rows.pairs,
                       p99_us=rows.get("p99_ns", float("nan")) / (rows.pairs / rows.frames) / 1e3,
                       build_ms=rows.build_ns / 1e6, memory_mb=rows.get("bytes", float("nan")) / 1e6)
    measured = ["us", "wrong", "p99_us", "build_ms", "memory_mb"]
    drawn = [c for c in ("seed",) if c in rows]
    whole = rows.groupby([*keys, *drawn], sort=False, dropna=False)
    table = whole[measured].median().groupby(keys, sort=False, dropna=False).mean().reset_index()
    first = rows.groupby(keys, sort=False, dropna=False).first().reset_index()
    table["scene"] = [", ".join([rows.attrs["name"], *(text_of(row, c) for c in place)]) for _, row in table.iterrows()]
    table["side"] = table[side] + (", " + table.program if "program" in table else "")
    table["times"] = table.us / table.groupby("scene").us.transform("min")
    table["configuration"] = [said[row.peer][0] if row.peer in said else row.peer or ours(row) for _, row in first.iterrows()]
    table["chosen_by"] = [said.get(row.peer, ("", ""))[1] if row.peer else "we" for _, row in first.iterrows()]
    return table[list(COLUMNS)]


def text_of(row, column):
    value = row[column]
    return str(value) if isinstance(value, str) else f"{value:g} {column}"


def ours(row):
    parts = [row.get("configuration", ""), row.get("volume", ""), row.get("strategy", ""), row.get("build", "")]
    return ", ".join(str(part) for part in parts if part not in ("", None) and part == part)


def board(all_rows):
    said = settings_of_peers()
    tables = [table for rows in all_rows if len(table := of_record(rows, said))]
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=list(COLUMNS))


def html_of(all_rows):
    """A section of the report; nothing where no record has peers."""
    table = board(all_rows)
    if table.empty:
        return ""
    heads = "".join(f'<th scope="col"><button type="button">{html.escape(called or name.replace("_", " "))}</button></th>'
                    for name, called in COLUMNS.items())
    lines = "\n".join("<tr>" + "".join(map(cell, row)) + "</tr>" for row in table.itertuples(index=False))
    return ('<section id="board"><h2><a href="#board">Board</a></h2><p class="asks">Every library and ours on every scene: time '
            "against wrong answers. Who answers otherwise stays in, with how often.</p>"
            f'<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>\n{lines}\n</tbody></table></div></section>\n')


def cell(value):
    if isinstance(value, str):
        return f"<td>{html.escape(value)}</td>"
    return "<td class=n></td>" if value is None or value != value else f"<td class=n>{value:.3g}</td>"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("records", nargs="+", metavar="RECORD")
    parser.add_argument("--out", help="a CSV file, in place of the table")
    arguments = parser.parse_args()
    table = board([records.read(record) for record in arguments.records])
    if arguments.out:
        table.to_csv(arguments.out, index=False)
    else:
        print(table.drop(columns=["configuration"]).round(3).to_string(index=False))

