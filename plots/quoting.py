# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of README.md, the pages of experiments/ and the paper: each computed in one place, from the records.

    @quotes("boxes-fast")
    def boxes_precision(record):
        return {"blocks": ..., "rows": [[cell, ...], ...]}

A page is made from its template, plots/texts/<page>.in, in which a number is written as <<function.key:format>>:

    `blocks` takes a median of <<boxes_precision.blocks:.2f>> of its time in double.

A value may be a number, a name, a list of them, which is written "1, 2 and 3", an Interval, which is written "1.5 to
1.6", and "1.6" where both ends are the same when rounded, or the rows of a table. What a sentence says in words is
claimed where its numbers are computed: claim(raise_is_best, "raise is the fastest"). A number that no record gives
has its reason beside it: <<500 polygons|what the definition sets>>.
"""

import contextlib
import io
import math
import re
from functools import cache
from pathlib import Path

from bvlab_plots.refused import Refused
from bvlab_plots.words import span

ROOT = Path(__file__).resolve().parent.parent
RECORDS = ROOT / "experiments" / "record"
TEXTS = ROOT / "plots" / "texts"
PAPER = ROOT / "paper" / "main.tex"  # a template, too: paper/generate.py fills it in
# In a page: with k or M behind it, but not in a word (sweep1, float64, 26-DOP) nor a heading's.
SHOWN = re.compile(r"(?<![\w.-])(?:\d+(?:[ ,]\d{3})*(?:\.\d+)?(?!\w|\.\d|-[A-Za-z])|\d+(?:\.\d+)?[kM]\b)")
PLACE = re.compile(r"<<(\w+)\.(\w+)(?::([^<>|]*))?>>")
STATED = re.compile(r"<<([^<>|]+)\|[^<>|]+>>")
# Not read for numbers: places, code, the addresses of links, what a formula lowers or raises, the numbers of a list and
# the heads of tables.
UNREAD = re.compile(
    r"```.*?```|`[^`\n]*`|\]\([^)]*\)|<su[bp]>.*?</su[bp]>|https?://\S+|<!--.*?-->|<<[^<>]+>>"
    r"|^\*\*\d\.|^\d\. |^\|[^\n]*\|$(?=\n\|---)", re.DOTALL | re.MULTILINE
)
ALL = "*"  # in place of a record's name: the folder of them all
FUNCTIONS = {}
UNTRUE = []  # sentences that the records do not bear out, while a function computes values


def claim(holds, sentence):
    """What a page says in words: where it does not hold, numbers are still written, and the sentence is named."""
    if not holds:
        UNTRUE.append(sentence)


def quotes(names):
    """The function computes values from the records of these names, once."""
    names = [names] if isinstance(names, str) else list(names)

    def of(function):
        @cache
        def values(folder):
            UNTRUE.clear()
            with contextlib.redirect_stdout(io.StringIO()):  # what is left out is said where figures are drawn
                of_records = [folder] if names == [ALL] else [record_of(name, folder) for name in names]
                return function(*of_records), list(UNTRUE)

        if function.__name__ in FUNCTIONS:
            raise Refused(f"{function.__name__}: two functions of this name compute numbers")
        FUNCTIONS[function.__name__] = values
        return function

    return of


def numbers(name, records=RECORDS):
    """What the function of this name computes, by key, and the claims that do not hold."""
    if name not in FUNCTIONS:
        raise Refused(f"no function {name} computes numbers")
    return FUNCTIONS[name](records)


def record_of(name, records=RECORDS):
    folder = Path(records) / name
    if not (folder / "definition.toml").is_file():
        raise Refused(f"{name}: there is no record of it")
    return folder


class Interval:
    """Of several values the least and the largest; where they are the same when written, one."""

    def __init__(self, values):
        values = [float(value) for value in values]
        self.least, self.most = min(values), max(values)

    def __format__(self, spec):
        return span(written(self.least, spec), written(self.most, spec))


def is_table(value):
    return isinstance(value, (list, tuple)) and bool(value) and isinstance(value[0], (list, tuple))


def written(value, spec):
    """".2g" rounds to two digits and writes no exponent; "d" has blanks between thousands, "s" is 289k."""
    if is_table(value):
        return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in value).replace("|  |", "| |")
    if isinstance(value, (list, tuple)):
        texts = [written(each, spec) for each in value]
        return ", ".join(texts[:-1]) + " and " * (len(texts) > 1) + texts[-1]
    if isinstance(value, (str, Interval)):
        return format(value, spec)
    if spec.endswith("g"):
        value, digits = float(format(value, spec)), 0
        while digits < 12 and abs(round(value, digits) - value) > 1e-12 * abs(value):
            digits += 1
        return f"{value:.{digits}f}"
    if spec == "d":
        return f"{round(value):,}".replace(",", " ") if abs(value) >= 1e4 else str(round(value))
    if spec == "s":
        return short(value)
    return format(value, spec)


def two_digits(value):
    """At least two significant digits, zeros included, and no exponent: 0.20, 1.0, 36, 1043; "" where there is no value."""
    if value != value:
        return ""
    return f"{value:.{max(0, 1 - math.floor(math.log10(float(f'{value:.1e}'))))}f}"


def at_most(value, digits=2):
    """The value, rounded up: for what is said to be an upper bound."""
    return math.ceil(round(value * 10**digits, 6)) / 10**digits


def short(count):
    """3.4M, 289k, 940."""
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if count >= 0.9995 * size:
            scaled = count / size
            return f"{scaled:.1f}{letter}" if letter == "M" and scaled % 1 >= 0.05 else f"{scaled:.0f}{letter}"
    return f"{count:.0f}"


class Page:
    """A page as its template and the records say it, and what is wrong with either."""

    def __init__(self, name, template, records=RECORDS):
        self.name, self.template, self.records, self.faults = name, template, records, []

    def written(self):
        """The page. A place that cannot be filled in stays as it is and is a fault."""
        text = PLACE.sub(self.filled, self.template)
        return STATED.sub(r"\1", text)

    def filled(self, place):
        function, key, spec = place.groups()
        try:
            values, untrue = numbers(function, self.records)
            for sentence in untrue:
                self.fault(f"not so (any more): {sentence} [{function}]")
            return written(values[key], spec or "")
        except Exception as fault:  # a record of another form: the other places are still filled in
            self.fault(f"{place[0]}: {fault if isinstance(fault, Refused) else f'{type(fault).__name__}: {fault}'}")
            return place[0]

    def fault(self, text):
        if f"{self.name}: {text}" not in self.faults:
            self.faults.append(f"{self.name}: {text}")

    def uncovered(self):
        """(line, number, words around it) of each number that neither a record gives nor is said to be no record's."""
        unread = [match.span() for match in UNREAD.finditer(self.template)]
        for match in SHOWN.finditer(self.template):
            if not any(start < match.end() and match.start() < end for start, end in unread):
                around = " ".join(self.template[max(0, match.start() - 50):match.end() + 40].split())
                yield self.template.count("\n", 0, match.start()) + 1, match[0], around


def pages():
    """Every page that has a template, by the path of the page from the root."""
    for path in sorted(TEXTS.rglob("*.in")):
        yield Page(str(path.relative_to(TEXTS).with_suffix("")), path.read_text())
