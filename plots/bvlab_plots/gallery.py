# SPDX-License-Identifier: BSD-3-Clause
"""The gallery: every figure that a record's definition declares, beside the lines that declare it, on one page.

usage: gallery RECORD [--out DIR]

Writes DIR/index.html (build/gallery) and the figures beside it, as PDF, PNG, LaTeX and CSV. Made for the record of
experiments/definitions/every-figure.toml, which has one of every kind; any other record will do.
"""

import argparse
import csv
import html
import re
import sys
from pathlib import Path

from bvlab_plots import draw, records, style
from bvlab_plots.refused import Refused

ROOT = Path(__file__).resolve().parents[2]
HEAD = "[[figure]]"
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{name}: every figure</title><style>
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 75rem; margin: 0 auto; padding: 1rem; }}
section {{ display: grid; grid-template-columns: minmax(0, 3fr) minmax(0, 2fr); gap: 1.5rem; align-items: start;
  border-top: 1px solid #ddd; padding: 1rem 0; }}
h2 {{ grid-column: 1 / -1; font-size: 1.1rem; margin: 0; }}
img {{ max-width: 100%; }} pre {{ background: #f6f6f6; padding: .7rem; overflow-x: auto; font-size: .85rem; margin: 0 0 1rem; }}
td, th {{ text-align: left; padding: .1rem .7rem .1rem 0; font-size: .85rem; }}
@media (max-width: 50rem) {{ section {{ grid-template-columns: minmax(0, 1fr); }} }}
</style></head><body><h1>{name}: every figure</h1><p>{description}</p>
<p>Made by <code>{command}</code>, then <code>plots/draw {record}</code>. Beside each figure stands what declares it.
What keys there are: <code>experiments/definitions/README.md</code>.</p>
{sections}</body></html>
"""


def declarations(text):
    """Of each figure of a definition, by its name: the lines that declare it, and what the comment above it says."""
    found, comment = {}, []
    blocks = re.split(r"(?m)^(?=\[)|(?=^#)", text)
    for block in blocks:
        if block.startswith("#"):
            line, _, rest = block.partition("\n")
            comment.append(line.lstrip("# "))
            if rest.strip() == "" and "\n\n" not in block:
                continue
        elif block.startswith(HEAD):
            name = re.search(r'(?m)^name *= *"(.*)"', block)
            if name:
                found[name[1]] = (block.strip(), " ".join(comment))
        comment = []
    return found


def section_of(name, declared, comment, files):
    """HTML of one figure; `files` by their endings."""
    links = " ".join(f'<a href="{html.escape(file.name)}">{ending}</a>' for ending, file in files.items())
    shown = f'<img src="{html.escape(files["png"].name)}" alt="{html.escape(name)}" loading="lazy">' if "png" in files else ""
    if "csv" in files and "png" not in files:
        lines = list(csv.reader(files["csv"].read_text().splitlines()))
        cells = "".join("<tr>" + "".join(f"<{'td' if k else 'th'}>{html.escape(each)}</{'td' if k else 'th'}>" for each in line) + "</tr>"
                        for k, line in enumerate(lines))
        shown = f'<div style="overflow-x: auto"><table>{cells}</table></div>'
    latex = f"<pre>{html.escape(files['tex'].read_text())}</pre>" if "tex" in files and "png" not in files else ""
    return (f'<section id="{html.escape(name)}"><h2>{html.escape(name)}</h2><div>{shown}<p>{html.escape(comment)} {links}</p></div>'
            f"<div><pre>{html.escape(declared)}</pre>{latex}</div></section>")


def make(record, out):
    """Draws all figures of the record into the folder, and the page of them; says where. Refused where one cannot be
    drawn, by plots/draw's line."""
    record, out = Path(record), Path(out)
    definition = records.read_definition(record)
    declared = declarations((record / "definition.toml").read_text())
    if not declared:
        raise Refused(f"{record}: declares no [[figure]]")
    out.mkdir(parents=True, exist_ok=True)
    for old in [each for ending in draw.OUTPUTS for each in out.glob(f"*.{ending}")]:
        old.unlink()
    if draw.main([str(record), "--out", str(out)]):
        raise Refused(f"{record}: not every figure can be drawn")
    sections = []
    for name, (lines, comment) in declared.items():
        files = {ending: out / f"{name}.{ending}" for ending in draw.OUTPUTS if (out / f"{name}.{ending}").is_file()}
        sections.append(section_of(name, lines, comment, files))
    command = (record / "command.txt").read_text().strip() if (record / "command.txt").is_file() else "bvlab run"
    page = PAGE.format(name=html.escape(definition["name"]), description=html.escape(definition.get("description", "")),
                       command=html.escape(command), record=html.escape(str(record)), sections="\n".join(sections))
    return style.write(out, "index.html", page)


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record", type=Path)
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "gallery", help="folder of the page (default: build/gallery)")
    arguments = parser.parse_args(words)
    try:
        print(make(arguments.record, arguments.out))
    except (Refused, OSError) as fault:
        print(f"gallery: {fault}", file=sys.stderr)
        return 2
    return 0
