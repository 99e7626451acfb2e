# SPDX-License-Identifier: BSD-3-Clause
"""Says what became faster, slower or different from one record to another, cell by cell, with intervals.

usage: compare RECORD RECORD [--value EXPRESSION] [--all] [--csv FILE]

Cells are those that were set alike in both. A ratio of times (or of --value) is one of medians over repetitions; its
interval of 95 % is by bootstrap, of fewer than five repetitions the range of what their quotients can be. Faster or
slower is what the interval tells from 1. Different are answers and counts that are not the same.
"""

import argparse
import sys
from pathlib import Path

from bvlab_plots import comparing, records, style
from bvlab_plots.refused import Refused


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path, metavar="RECORD")
    parser.add_argument("after", type=Path, metavar="RECORD")
    parser.add_argument("--value", default="", help="what is compared (default: the record's first measure)")
    parser.add_argument("--clock", default="processor", choices=["processor", "wall"])
    parser.add_argument("--all", action="store_true", help="also the cells that are as before")
    parser.add_argument("--csv", type=Path, help="all cells as a table")
    return parser.parse_args(words)


def main(words=None):
    arguments = arguments_of(words)
    try:
        before, after = (records.read(record, clock=arguments.clock) for record in (arguments.before, arguments.after))
        found = comparing.compared(before, after, arguments.value)
        if arguments.csv:
            style.write(arguments.csv.parent, arguments.csv.name, found.to_csv(index=False))
        print(comparing.text_of(found, before, after, arguments.all), end="")
    except Refused as fault:
        print(f"compare: {fault}", file=sys.stderr)
        return 2
    except OSError as fault:
        print(f"compare: {fault.filename}: {fault.strerror}", file=sys.stderr)
        return 1
    return 0

