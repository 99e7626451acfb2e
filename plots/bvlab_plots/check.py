# SPDX-License-Identifier: BSD-3-Clause
"""draw --check DEFINITION: whether the figures of a definition can be drawn of the record that it will make.

`bvlab run` asks before its first cell, with a folder for DEFINITION: see to_come.py. Of a definition by itself the keys of
figures are checked alone.
"""

import argparse
import sys
import tempfile
import tomllib
from pathlib import Path

from bvlab_plots import figures
from bvlab_plots.refused import Refused


def main(words=None):
    parser = argparse.ArgumentParser(prog="draw", description=__doc__.splitlines()[0])
    parser.add_argument("--check", type=Path, required=True, metavar="DEFINITION")
    path = parser.parse_args(words).check
    try:
        check(path)
    except Refused as fault:
        print(f"draw: {path}: {fault}", file=sys.stderr)
        return 2
    return 0


def check(path):
    """Refused with the line of the first figure at fault."""
    path = path / "definition.toml" if (is_record := path.is_dir()) else path
    try:
        text = path.read_bytes().decode("utf-8-sig")
        definition = tomllib.loads(text)
    except (OSError, ValueError) as fault:
        raise Refused(f"{fault}".replace("\n", " ")) from None
    tables = definition.get("figure", [])
    if not isinstance(tables, list) or not all(isinstance(each, dict) for each in tables):
        raise Refused(f"line {line_of(text, lambda found: 'figure' in found)}: figures are written as [[figure]]")
    with tempfile.TemporaryDirectory() as scratch:
        record = None
        if is_record and tables:
            from bvlab_plots.to_come import RecordToCome  # it takes a second to import

            record = RecordToCome(path.parent, Path(scratch))
        for number, figure in enumerate(figures.each_declared(definition)):
            try:
                if isinstance(figure, Refused):
                    raise figure
                if record:
                    record.check(figure)
            except Refused as fault:
                name = tables[number].get("name", "")
                said = str(fault).removeprefix(f"figure {name}: ")
                raise Refused(f"line {line_of(text, begun(number, fault.key))}: figure '{name}': {said}") from None


def begun(number, key):
    """Whether a definition has the figure of a number, and the key in it."""
    def has(definition):
        tables = definition.get("figure", [])
        return len(tables) > number and (not key or key in tables[number])
    return has


def line_of(text, has):
    """The line with which a definition begins to have something."""
    lines, before = text.split("\n"), 0
    for number in range(1, len(lines)):
        try:
            if has(tomllib.loads("\n".join(lines[:number]))):
                break
            before = number
        except tomllib.TOMLDecodeError:  # within a value of several lines
            continue
    return before + 1
