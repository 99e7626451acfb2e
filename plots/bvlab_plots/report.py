# SPDX-License-Identifier: BSD-3-Clause
"""Makes a page of records that is read in a browser and needs no network: build/report/index.html.

usage: report [RECORDS ...] [--out DIR] [--no-scenes]

Of each record: what it asks, what it says, figures (those in RECORD/figures, else they are drawn), the medians as a
table, the command, the machine, the commit and the definition. Scenes in 3D are made by build/release/bvlab where
that is built, notebooks where tests/run has made them. Without RECORDS those of experiments/record.
"""

import argparse
import re
import shutil
import sys
from html import unescape
from pathlib import Path

from bvlab_plots import report_page, report_scenes
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


def notebooks(rendered, out):
    """Copies the pages of notebooks in the folder `rendered`, as tests/run made them, to OUT/notebooks; name, title and file
    of each."""
    for page in sorted(Path(rendered).glob("*.html")):
        (out / "notebooks").mkdir(parents=True, exist_ok=True)
        shutil.copy(page, out / "notebooks" / page.name)
        title = re.search(r"<h1[^>]*>(.*?)(<a|</h1>)", page.read_text(), re.DOTALL)
        yield page.stem, unescape(title[1]).strip() if title else "", f"notebooks/{page.name}"


def make(arguments):
    sections = [report_page.section_of(record, arguments.out) for record in arguments.records or all_records()]
    scenes = [] if arguments.no_scenes else report_scenes.make(ROOT / "build" / "release" / "bvlab", arguments.out)
    return report_page.write(sections, scenes, arguments.out, list(notebooks(ROOT / "build" / "notebooks", arguments.out)))


def main(words=None):
    try:
        print(make(arguments_of(words)))
    except (Refused, OSError) as fault:
        print(f"report: {fault}", file=sys.stderr)
        return 2
    return 0

