# SPDX-License-Identifier: BSD-3-Clause
"""Makes a page of records that is read in a browser and needs no network: build/report/index.html.

usage: report [RECORDS ...] [--out DIR] [--no-scenes]

Of each record: what it asks, what it says, figures (those in RECORD/figures, else they are drawn), the medians as a
table, the command, the machine, the commit and the definition. Scenes in 3D are made by build/release/bvlab where
that is built, notebooks where tests/run has made them. Without RECORDS those of experiments/record.
"""

import argparse
import sys
from pathlib import Path

from bvlab_plots import report_notebooks, report_page, report_scenes
from bvlab_plots.refused import Refused

ROOT = Path(__file__).resolve().parents[2]


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("records", type=Path, nargs="*", metavar="RECORD", help="folders of records")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "report", help="folder of the page")
    parser.add_argument("--no-scenes", action="store_true", help="leave out the scenes in 3D")
    return parser.parse_args(words)


def all_records():
    found = [path.parent for path in (ROOT / "experiments" / "record").glob("*/definition.toml")]
    if not found:
        raise Refused("experiments/record: no records; name some")
    return found


def make(arguments):
    sections = [report_page.section_of(record, arguments.out) for record in arguments.records or all_records()]
    scenes = [] if arguments.no_scenes else report_scenes.make(ROOT / "build" / "release" / "bvlab", arguments.out)
    notebooks = report_notebooks.make(ROOT / "build" / "notebooks", arguments.out)
    return report_page.write(sections, scenes, arguments.out, notebooks)


def main(words=None):
    try:
        print(make(arguments_of(words)))
    except (Refused, OSError) as fault:
        print(f"report: {fault}", file=sys.stderr)
        return 2
    return 0

