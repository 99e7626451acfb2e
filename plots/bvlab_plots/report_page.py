# SPDX-License-Identifier: BSD-3-Clause
"""The report as HTML: a section for each record, and the page around them."""

import html
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import markdown  # type: ignore[import]
import pandas as pd

from bvlab_plots import findings, provenance, records, style, words

PLOTS = Path(__file__).resolve().parents[1]
MOST_ROWS = 1000  # of a table; the record has them all
LINK = re.compile(r"\]\((?:\.\./)?record/")
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
MARKS = re.compile(r"[^\w.-]+")


class Section(NamedTuple):
    record: Path
    rows: pd.DataFrame
    figures: list  # files beside the page

    @property
    def name(self):
        return self.rows.attrs["name"]

    @property
    def folder(self):
        return self.record.resolve().name


def section_of(record, out):
    """Reads a record, and puts its figures beside the page."""
    rows = records.read(record)
    return Section(record, rows, figures_of(record, rows.attrs["name"], out))


def read_text(path):
    return path.read_text() if path.is_file() else ""


def story():
    """The pages of results, in the order in which they are read: their paragraphs."""
    folder = PLOTS.parent / "experiments"
    pages = [folder / "results.md", folder / "seeds.md", *sorted((folder / "results").glob("*.md"))]
    return [part for page in pages for part in COMMENT.sub("", read_text(page)).strip().split("\n\n")]


def mentions(part, record):
    return re.search(rf"\]\((?:\.\./)?record/{re.escape(record.resolve().name)}[)/]", part)


def is_ours(record):
    return record.resolve().parent == PLOTS.parent / "experiments" / "record"


def paragraphs_on(record):
    """Those that link to this record, and what follows under the same heading until another record is linked to; of tables
    that link to records, the rows that link to this one. Their numbers are held against the records by a test. Limits are
    those of all records."""
    found, here, of_all = [], False, False
    for part in story() if is_ours(record) else []:
        if part.startswith("#"):
            here, of_all = False, part.startswith("## Limits")
        elif part.startswith("|") and LINK.search(part):
            head, rule, *lines = part.splitlines()
            if lines := [line for line in lines if mentions(line, record)]:
                found.append("\n".join([head, rule, *lines]))
            continue
        elif not part.startswith("!") and not of_all and LINK.search(part):
            here = bool(mentions(part, record))
        if here and not part.startswith(("!", "#")):
            found.append(part)
    return found


def place_in_story(record):
    """After which paragraph a record comes: as the pages tell of them, then what they leave out."""
    parts = story() if is_ours(record) else []
    return next((place for place, part in enumerate(parts) if mentions(part, record)), len(parts))


def figures_of(record, name, out):
    folder = Path("figures") / MARKS.sub("-", f"{record.resolve().parent.name}-{record.resolve().name}")
    (out / folder).mkdir(parents=True, exist_ok=True)
    for old in (out / folder).glob("*.p*"):
        old.unlink()
    for figure in sorted((record / "figures").glob("*.png")):
        shutil.copy(figure, out / folder)
    if not any((out / folder).glob("*.png")):
        drawn(record, name, out / folder)
    return [(folder / path.name).as_posix() for path in sorted((out / folder).glob("*.png"))]


def drawn(record, name, folder):
    """What the record's own script draws, where it has one, or plots/draw."""
    own = PLOTS / "bvlab_scripts" / f"{name.replace('-', '_')}.py"
    for program in ([["script", name]] if own.is_file() else []) + [["draw"]]:
        if not any(folder.glob("*.png")):
            words = [sys.executable, "-B", PLOTS / program[0], *program[1:], record, "--out", folder]
            subprocess.run(words, capture_output=True, check=False)
    for other in folder.glob("*.pdf"):
        other.unlink()


def medians(rows):
    """A line for each setting, what is measured as the median over repetitions; columns that say the same
    everywhere are left out."""
    settings = [c for c in rows.attrs["settings"] if rows[c].nunique() > 1 and c != "repetition"]
    measured = [c for c in rows if c not in rows.attrs["settings"] and c not in ("variant", "repetition")
                and pd.api.types.is_numeric_dtype(rows[c]) and rows[c].notna().any() and rows[c].nunique() > 1]
    if not settings:
        return rows[measured]
    return rows.groupby(settings, sort=False, dropna=False)[measured].median().reset_index()


# HTML

def text(value):
    return html.escape(str(value))


def link(file):
    """The address of a file beside the page, whatever its name holds."""
    return text(quote(file))


def cell(value):
    if isinstance(value, str):
        return f"<td>{text(value)}</td>"
    if pd.isna(value):
        return "<td></td>"
    shown = f"{value:,.0f}" if value == int(value) and abs(value) < 1e15 else f"{value:.4g}"
    return f"<td class=n>{shown}</td>"


def table_of(section):
    table, units = medians(section.rows), section.rows.attrs["units"]
    heads = "".join(head(column, units.get(column, ""), section.rows.attrs["kind"]) for column in table)
    shown = table.head(MOST_ROWS).astype(object)
    lines = "\n".join(f"<tr>{''.join(map(cell, row))}</tr>" for row in shown.itertuples(index=False))
    left_out = f'<p class="faint">The first {MOST_ROWS:,} of {len(table):,} rows.</p>' if len(table) > MOST_ROWS else ""
    return (f'<details class="table"><summary>Table: {len(table):,} settings, medians over repetitions</summary>'
            f'{left_out}<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>\n{lines}\n</tbody></table>'
            "</div></details>")


def from_markdown(part):
    """A paragraph, list or table of a page as HTML, links without addresses."""
    part = re.sub(r"\(\[record\]\([^)]*\)(?:[:,;] )?", "(", part).replace(" ()", "")
    part = re.sub(r"^\(\)\s*", "", part)
    part = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", part).replace("N<sub>", "<i>N</i><sub>")
    # What stood in parentheses beside the link to the record begins the paragraph.
    part = re.sub(r"^\(([^()]*?)\.?\)\.?\s*", lambda m: f"{m[1][:1].upper()}{m[1][1:]}. ", part)
    return markdown.markdown(part, extensions=["tables"])


def head(column, unit, kind):
    title = words.called(column, kind) + (f", {unit}" if unit else "")
    return f'<th scope="col" title="{text(title)}"><button type="button">{text(column)}</button></th>'


def facts_of(section):
    machine = dict(section.rows.attrs["machine"])
    by = provenance.made(machine)
    if str(machine.get("memory", "")).endswith(" kB"):
        machine["memory"] = f"{int(machine['memory'].split()[0]) / 1e6:.0f} GB"
    merged = f", merged as <code>{text(by.merged_as)}</code>" if by.merged_as else ""
    facts = [("Command", f"<code>{text(read_text(section.record / 'command.txt').strip())}</code>"),
             ("Commit", f"<code>{text(by.commit)}</code>{' with changes' if by.changes else ''}{merged} (bvlab {text(by.version)})"
              if by.commit else ""), ("Date", text(by.date)),
             ("Machine", text(", ".join(f"{machine[k]}{' cores' if k == 'cores' else ''}" for k in
                                        ("processor", "cores", "memory", "system") if k in machine))),
             ("Compiler", text(f"{machine.get('compiler', '')} {machine.get('flags', '')}")),
             ("Libraries", text(machine.get("libraries", ""))), ("Record", f"<code>{text(section.folder)}</code>")]
    facts = [(name, value) for name, value in facts if value.strip()]
    lines = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in facts)
    definition = text(read_text(section.record / "definition.toml").strip())
    return f'<dl>{lines}</dl><details><summary>Definition</summary><pre>{definition}</pre></details>'


def html_of(section, anchor):
    said, unfinished = findings.sentence_of(section.rows), section.rows.attrs["unfinished"]
    results = "".join(map(from_markdown, paragraphs_on(section.record)))  # what the pages of results say of it
    figures = "".join(f'<a href="{link(file)}"><img src="{link(file)}" alt="{text(section.name)}: {text(Path(file).stem)}" '
                      'loading="lazy"></a>' for file in section.figures)
    return (f'<section id="{anchor}" class="experiment"><h2><a href="#{anchor}">{text(section.name)}</a></h2>'
            f'<p class="asks">{text(section.rows.attrs["definition"].get("description", ""))}</p>'
            + (f"<p><strong>Unfinished: {text(unfinished)}.</strong></p>" if unfinished else "")
            + (f'<p class="says">{text(said)}</p>' if said else "")
            + (f'<div class="results">{results}</div>' if results else "")
            + f'<div class="figures">{figures}</div>{table_of(section)}{facts_of(section)}</section>')


def list_of(anchor, title, pages):
    """Pages that stand beside this one: name, description and file of each."""
    shown = "".join(f'<li><a href="{link(file)}">{text(name)}</a> <span>{text(description)}</span></li>'
                    for name, description, file in pages)
    return f'<section id="{anchor}"><h2>{title}</h2><ul>{shown}</ul></section>' if pages else ""


def write(sections, scenes, out, notebooks=()):
    """Writes OUT/index.html with what it needs in it, and figures and scenes beside it; says where."""
    sections = sorted(sections, key=lambda section: (place_in_story(section.record), section.name, section.folder))
    anchors = [MARKS.sub("-", f"{section.name}-{section.folder}") for section in sections]
    links = "".join(f'<li><a href="#{anchor}">{text(section.name)}</a></li>'
                    for section, anchor in zip(sections, anchors))
    parts = {"links": links, "count": str(len(sections)),
             "scenes": list_of("scenes", "Scenes in 3D", scenes) + list_of("notebooks", "Notebooks", notebooks),
             "sections": "\n".join(html_of(section, anchor) for section, anchor in zip(sections, anchors))}
    folder = PLOTS / "page"
    page = (folder / "report.html").read_text()
    page = re.sub(r'<link rel="stylesheet" href="(.*?)">', lambda m: f"<style>\n{(folder / m[1]).read_text()}</style>", page)
    page = re.sub(r'<script src="(.*?)"></script>', lambda m: f"<script>\n{(folder / m[1]).read_text()}</script>", page)
    return style.write(out, "index.html", re.sub(r"<!--(\w+)-->", lambda m: parts[m[1]], page))
