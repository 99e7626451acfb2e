# SPDX-License-Identifier: BSD-3-Clause
"""Draws the figures of a record: those that its definition declares as [[figure]], or one for each axis.

usage: draw RECORD [--out DIR] [--x C --y C --over V --series C --panels C]
       draw --check DEFINITION

The tables of a record from before its definition declared figures are those of the definition of that name in
experiments/definitions, and --figures takes those of any other. experiments/definitions/README.md has all keys.
A figure that cannot be drawn is named on standard error, and the others are drawn.
"""

import argparse
import sys
from pathlib import Path

from bvlab_plots import arguments as command_line, figures, kinds, records, style, tables
from bvlab_plots.refused import Refused

DEFINITIONS = Path(__file__).resolve().parents[2] / "experiments" / "definitions"
OPTIONS = [key for key in figures.KEYS if key != "table"]  # which is --frames
OUTPUTS = ["pdf", "png", "tex", "csv"]


def formats_of(text):
    formats = [each.strip() for each in text.split(",")]
    for each in formats:
        if each not in OUTPUTS:
            raise Refused(f"--formats: no '{each}'; available: {', '.join(OUTPUTS)}")
    return formats


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record", type=Path)
    parser.add_argument("--check", metavar="DEFINITION", help="alone: whether its figures can be drawn; see check.py")
    parser.add_argument("--out", type=Path, help="folder for the figures (default: RECORD/figures)")
    parser.add_argument("--figures", type=Path, help="a definition whose [[figure]] tables are drawn")
    parser.add_argument("--table", action="store_true", help="print the medians, draw nothing")
    parser.add_argument("--formats", metavar="F,F", help="pdf, png, tex, csv (default: pdf,png; of tables tex,csv)")
    parser.add_argument("--style", metavar="FILE", help="matplotlib's settings (rcParams), a file or a style by its name")
    parser.add_argument("--frames", action="store_true", help="rows of single frames, NAME.frames.csv")
    for key in OPTIONS:
        repeatable = {"action": "append", "metavar": "NAME=VALUE"} if key == "where" else {}
        parser.add_argument(f"--{key.replace('_', '-')}", help=figures.KEYS[key].replace("%", "%%"), **repeatable)
    return parser.parse_args(words)


def wanted(arguments, rows):
    """The figures to draw: of the command line, declared, or of each axis; and what is wrong with others."""
    given = {key: getattr(arguments, key) for key in OPTIONS if getattr(arguments, key) is not None}
    if arguments.frames:
        given["table"] = "frames"
    if given:
        if "x" not in given:
            raise Refused(f"--x is needed with --{min(given)}")
        given.setdefault("name", "-".join(filter(str.isalnum, given["x"].replace("_", " ").split())) or "figure")
        if "series" not in given:
            alone = given.get("kind") in ("map", "stacked")
            given["series"] = "" if alone else figures.series_for(rows, given["x"])
        return [figures.figure_from(given)], []
    definition = rows.attrs["definition"]
    if arguments.figures:
        definition = records.read_toml(arguments.figures)
    elif "figure" not in definition:
        same = DEFINITIONS / f"{definition['name']}.toml"
        definition = records.read_toml(same) if same.is_file() else definition
    declared, faults = figures.declared(definition)
    return declared or ([] if faults else figures.of_each_axis(rows)), faults


def written(figure, found, out, formats):
    """Files of one figure; the name of the one to look at."""
    formats = formats or (["tex", "csv"] if figure.kind == "table" else ["pdf", "png"])
    texts = {"tex": tables.to_latex, "csv": tables.to_csv}
    names = [style.write(out, f"{figure.name}.{each}", texts[each](figure, found)) for each in formats if each in texts]
    pictures = [each for each in formats if each not in texts]
    if pictures and figure.kind == "table":
        raise Refused(f"figure {figure.name}: a table is written as tex and csv")
    if pictures:
        drawing = kinds.drawing_of(figure, found)
        names.append(style.save(drawing, out, figure.name, pictures))
        if figure.caption == "beside":
            names.append(style.write(out, f"{figure.name}.txt", drawing.caption + "\n"))
    return names


def figures_of(arguments):
    """The rows of the record, the figures to draw of them, and what is wrong with others."""
    rows = kinds.Rows(arguments.record)
    all_rows = rows.of(figures.Figure(name="", x="", clock=arguments.clock or ""))
    records.wrong_answers(all_rows)
    return rows, *wanted(arguments, all_rows)


def draw_all(arguments):
    """How many figures were refused."""
    formats = formats_of(arguments.formats) if arguments.formats else []
    out = arguments.out or arguments.record / "figures"
    if not arguments.table:
        command_line.require_folder(out)
    rows, wanted_figures, faults = figures_of(arguments)
    for fault in faults:
        complain(arguments, fault)
    refused = {}  # what is wrong, and with which figures
    for figure in wanted_figures:
        try:
            found = kinds.points_of(rows.of(figure), figure)
            if arguments.table:
                print(tables.of(figure, found))
            else:
                print(*written(figure, found, out, formats), sep="\n")
        except Refused as fault:
            refused.setdefault(str(fault).removeprefix(f"figure {figure.name}: "), []).append(figure.name)
    for text, names in refused.items():
        complain(arguments, f"figure {', '.join(names)}: {text}")
    return len(faults) + len(refused)


def complain(arguments, text):
    text = text if text.startswith(str(arguments.record)) else f"{arguments.record}: {text}"
    print(f"draw: {text}", file=sys.stderr)


def main(words=None):
    arguments = arguments_of(words)
    try:
        with style.settings(arguments.style):
            return 2 if draw_all(arguments) else 0
    except Refused as fault:
        complain(arguments, str(fault))
        return 2
    except OSError as fault:
        print(f"draw: {fault.filename or arguments.record}: {fault.strerror}", file=sys.stderr)
        return 1

