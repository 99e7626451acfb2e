# SPDX-License-Identifier: BSD-3-Clause
"""What the paper takes from records: numbers by name, tables, texts and figures in the folder that LaTeX reads."""

import functools
import sys
from pathlib import Path

import records


class Paper:
    """`numbers` holds what stands in the paper, as LaTeX, by the name of its macro; `values` the numbers themselves.

    Without `out` nothing is written or drawn: the numbers alone are worked out."""

    def __init__(self, records, out=None):
        self.records, self.out = Path(records), out and Path(out)
        self.numbers, self.values = {}, {}
        # What one part finds and another needs: the law's constant, cells of the tournament in which a shell is best.
        self.kappa = self.shell_best = None
        for folder in ("tables", "figures", "have") if self.out else ():
            (self.out / folder).mkdir(parents=True, exist_ok=True)

    def record(self, name):
        """The folder of an experiment, or nothing where there is no record of it."""
        found = latest(self.records, name)
        print(f"{name}: {found or 'no record'}", file=sys.stderr)
        return found

    def put(self, name, value, text):
        self.values[name], self.numbers[name] = value, text

    def put_times(self, **values):
        """How many times something is something else."""
        for name, value in values.items():
            self.put(name, value, times(value))

    def put_percent(self, digits=1, **shares):
        for name, value in shares.items():
            self.put(name, value, percent(value, digits))

    def put_range(self, name, values, form=None):
        """The least and the most, as nameLeast and nameMost."""
        form = form or times
        self.put(name + "Least", min(values), form(min(values)))
        self.put(name + "Most", max(values), form(max(values)))

    def put_text(self, **texts):
        for name, text in texts.items():
            self.put(name, text, str(text))

    def have(self, name):
        if self.out:
            (self.out / "have" / f"{name}.tex").write_text("% there is a record\n")

    def text(self, name, text):
        if self.out:
            (self.out / "tables" / f"{name}.tex").write_text(text.strip() + "%\n")

    def table(self, name, alignment, header, rows, above=()):
        """`above`: lines of LaTeX over the header; a row that is a string is LaTeX, too."""
        lines = [
            r"\begin{tabular}{@{}" + alignment + "@{}}",
            r"\toprule",
            *above,
            " & ".join(header) + r" \\",
            r"\midrule",
        ]
        lines += [row if isinstance(row, str) else " & ".join(row) + r" \\" for row in rows]
        lines += [r"\bottomrule", r"\end{tabular}"]
        self.text(name, "\n".join(lines))

    def figures(self):
        """Where figures go, or nothing where none are drawn."""
        return self.out and self.out / "figures"

    def write_numbers(self):
        text = "".join(f"\\newcommand{{\\{name}}}{{{value}}}\n" for name, value in self.numbers.items())
        (self.out / "numbers.tex").write_text(text)


def part(name):
    """A part of the paper that one record gives: left out where there is none."""

    def of(write):
        @functools.wraps(write)
        def written(paper):
            record = paper.record(name)
            if record:
                write(paper, record)
                paper.have(name)

        return written

    return of


def latest(folder, name):
    """An experiment's record, which bears its name, or nothing."""
    found = Path(folder) / name
    return found if (found / f"{name}.csv").is_file() else None


def percent(value, digits=1):
    return signed(f"{100 * value:.{digits}f}\\,\\%")


def signed(text):
    """With a minus and not a hyphen."""
    return text.replace("-", "$-$", 1) if text.startswith("-") else text


def times(value):
    """A ratio as it is read: 0.93, 1.4, 12, 340."""
    return f"{value:.2f}" if value < 1.995 else f"{value:.1f}" if value < 9.95 else f"{value:,.0f}".replace(",", r"\,")


def count(value):
    return f"{value:,.0f}".replace(",", r"\,")


def thousands(value):
    """A count in a narrow column: 850, 12k, 3.4M."""
    for size, unit in ((1e6, "M"), (1e3, "k")):
        if value >= size:
            return f"{value / size:.{1 if value < 9.95 * size and unit == 'M' else 0}f}{unit}"
    return f"{value:.0f}"


def duration(ns):
    """Nanoseconds as they are read."""
    for size, unit in ((1e9, "s"), (1e6, "ms"), (1e3, r"$\mu$s"), (1, "ns")):
        if ns >= size or size == 1:
            value = ns / size
            return f"{value:.{0 if value >= 99.5 else 1 if value >= 9.95 else 2}f}\\,{unit}"


def escape(text):
    return str(text).replace("_", r"\_").replace("%", r"\%").replace("&", r"\&")


def listed(names, last="and"):
    """a, b and c."""
    names = list(names)
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + f" {last} " + names[-1] if names else "none"


def medians(rows, keys, column):
    """The median over repetitions, and seeds where there are several."""
    return rows.groupby(keys, sort=False, as_index=False, dropna=False)[column].median()


def read_right(record):
    """The rows of a record; refused where an answer of ours differs from the reference. Peers' stay in, and `wrong`
    says of which they differ."""
    rows = records.read(record)
    attrs = rows.attrs
    rows["wrong_answer"] = records.wrong_answers(rows)
    rows.attrs.update(attrs)
    return rows
