# SPDX-License-Identifier: BSD-3-Clause
"""Sentences and tables whose numbers come from records: where they stand in a page, what they say, what should stand.

    @quotes("boxes-precision", RESULTS, "`blocks` takes a median of {blocks:.2f} of its time in double")
    def boxes_precision(record):
        return {"blocks": ...}

A quote is a piece of a page with places for numbers, {name:format}; the function computes the values from the record
of that name, or of several. Line breaks are as the page has them. A value may be a number, a name ({best}), a list of
them, which is written "1, 2 and 3", or an Interval, which is written "1.5 to 1.6", and "1.6" where both ends are the
same when rounded. What a page says in words is claimed: claim(raise_is_best, "raise is the fastest").

A table is a quote that begins with the line of its columns; the function gives {"rows": [[cell, ...], ...]}.

Numbers that no record gives (published ones, what a definition sets, units) are said to be such: stated(page, why, text).
"""

import contextlib
import io
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from refused import Refused

ROOT = Path(__file__).resolve().parent.parent
RECORDS = ROOT / "experiments" / "record"
README, RESULTS = "README.md", "experiments/results.md"
PAGES = [README, RESULTS]
NUMBER = r"[-+]?\d+(?:[ ,]\d{3})*(?:\.\d+)?"
# In a page: with k or M behind it, but not in a word (sweep1, float64, 26-DOP) nor a heading's.
SHOWN = re.compile(r"(?<![\w.-])(?:\d+(?:[ ,]\d{3})*(?:\.\d+)?(?!\w|\.\d|-[A-Za-z])|\d+(?:\.\d+)?[kM]\b)")
PLACE = re.compile(r"\{(\w+)(?::([^}]*))?\}")
# Not read for numbers: code, the addresses of links, what a formula lowers or raises.
UNREAD = re.compile(r"```.*?```|`[^`\n]*`|\]\([^)]*\)|<su[bp]>.*?</su[bp]>|https?://\S+", re.DOTALL)


UNTRUE = []  # sentences that records do not bear out any more, while a function computes values


def claim(holds, sentence):
    """What a page says in words: where it does not hold, numbers are still written, and the sentence is named."""
    if not holds:
        UNTRUE.append(sentence)


class Interval:
    """Of several values the least and the largest; where they are the same when written, one."""

    def __init__(self, values):
        values = [float(value) for value in values]
        self.least, self.most = min(values), max(values)

    def __format__(self, spec):
        least, most = written(self.least, spec), written(self.most, spec)
        return least if least == most else f"{least} to {most}"


def written(value, spec):
    """".2g" rounds to two digits and writes no exponent; "d" has blanks between thousands, "s" is 289k."""
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


def short(count):
    """3.4M, 289k, 940."""
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if count >= 0.9995 * size:
            scaled = count / size
            return f"{scaled:.1f}{letter}" if letter == "M" and scaled % 1 >= 0.05 else f"{scaled:.0f}{letter}"
    return f"{count:.0f}"


@dataclass
class Quote:
    page: str
    text: str
    values: object  # a function of no arguments: the values, and what does not hold of what is claimed

    @property
    def is_table(self):
        return self.text.lstrip().startswith("|")

    def name(self):
        first = " ".join(self.text.split())
        return f"{self.page}: \"{first[:90]}{'...' if len(first) > 90 else ''}\""


@dataclass
class Stated:
    page: str
    why: str
    text: str


QUOTES, STATED = [], []


def quotes(names, page, *texts):
    """Says that the texts stand in the page, with values from the records of these names."""
    names = [names] if isinstance(names, str) else list(names)

    def of(function):
        @cache
        def values():
            UNTRUE.clear()
            with contextlib.redirect_stdout(io.StringIO()):  # what is left out is said where figures are drawn
                return function(*(record_of(name) for name in names)), list(UNTRUE)
        for text in texts:
            QUOTES.append(Quote(page, text, values))
        # Another page may quote the same values: they are computed once.
        function.also = lambda other, *more: QUOTES.extend(Quote(other, text, values) for text in more)
        return function
    return of


def stated(page, why, *texts):
    STATED.extend(Stated(page, why, text) for text in texts)


def record_of(name):
    folder = RECORDS / name
    if not (folder / "definition.toml").is_file():
        raise Refused(f"{name}: there is no record of it")
    return folder


def pattern(text):
    """A text as an expression: blanks are any, places are numbers or names, in groups."""
    parts, last = [], 0
    text = text.strip()
    for place in PLACE.finditer(text):
        parts += [literal(text[last:place.start()]), place_pattern(place[2])]
        last = place.end()
    return re.compile("".join(parts + [literal(text[last:])]))


def literal(text):
    # Blanks are kept as the page has them: groups of their own.
    return "".join(r"(\s+)" if part.isspace() else re.escape(part) for part in re.split(r"(\s+)", text) if part)


def place_pattern(spec):
    if not spec:
        return r"(\S(?:[^\n]*?\S)??)"
    return rf"({NUMBER}[kM]?(?:(?:\s+to\s+|\s+and\s+|,\s+){NUMBER}[kM]?)*)"


def found(quote, text):
    """Where a quote stands in the page; refused unless it is there once."""
    if quote.is_table:
        start = text.find(quote.text.strip() + "\n")
        if start < 0:
            raise Refused(f"{quote.name()} does not stand there")
        end = re.compile(r"(?:\|.*(?:\n|\Z))+").match(text, start).end()
        return start, end, None
    matches = list(pattern(quote.text).finditer(text))
    if len(matches) != 1:
        raise Refused(f"{quote.name()} stands there {len(matches)} times, not once")
    return matches[0].start(), matches[0].end(), matches[0]


def said(quote, values, match):
    """The text that should stand: with the record's values, and the page's line breaks."""
    if quote.is_table:
        head = quote.text.strip()
        lines = [head, "|" + "---|" * (head.count("|") - 1)]
        return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in values["rows"]]).replace("|  |", "| |") + "\n"
    blanks = iter(group for group in match.groups() if group.isspace())
    text, parts = quote.text.strip(), []
    for piece in re.split(r"(\{\w+(?::[^}]*)?\})", text):
        place = PLACE.fullmatch(piece)
        if place:
            parts.append(written(values[place[1]], place[2] or ""))
        else:
            parts.append(re.sub(r"\s+", lambda _: next(blanks), piece))
    return "".join(parts)


def covered(quote, start, match, end):
    """The parts of a page in which numbers are computed: a table, or the places."""
    if match is None:
        return [(start, end)]
    return [match.span(i) for i, group in enumerate(match.groups(), 1) if not group.isspace()]


class Page:
    """A page as it stands and as it should."""

    def __init__(self, name, text=None):
        self.name, self.faults = name, []
        self.text = (ROOT / name).read_text() if text is None else text
        self.pieces = []  # (start, end, what should stand)
        self.known = []
        for quote in (quote for quote in QUOTES if quote.page == name):
            try:
                start, end, match = found(quote, self.text)
                self.known += covered(quote, start, match, end)
                values, untrue = quote.values()
                self.faults += [fault for each in untrue if (fault := f"{name}: no longer so: {each}") not in self.faults]
                stands, should = self.text[start:end], said(quote, values, match)
                same = stands == should if quote.is_table else stands.split() == should.split()
                self.pieces.append((start, end, stands if same else should, quote))
            except Refused as fault:
                text = str(fault)
                self.faults.append(text if text.startswith(name) else f"{quote.name()}: {text}")
            except Exception as fault:  # a record of another form: the other quotes are still looked at
                self.faults.append(f"{quote.name()}: {type(fault).__name__}: {fault}")
        self.pieces.sort(key=lambda piece: piece[:2])
        for (_, end, _, before), (start, _, _, quote) in zip(self.pieces, self.pieces[1:]):
            if start < end:
                self.faults.append(f"{quote.name()} overlaps \"{before.text[:40]}\"")

    def differences(self):
        return [(quote, self.text[start:end], said) for start, end, said, quote in self.pieces
                if self.text[start:end] != said]

    def rewritten(self):
        parts, last = [], 0
        for start, end, said, _ in self.pieces:
            if start >= last:
                parts += [self.text[last:start], said]
                last = end
        return "".join(parts + [self.text[last:]])

    def uncovered(self):
        """(line, number, words around it) of each number that neither a record gives nor is said to be no record's."""
        known = list(self.known) + [match.span() for match in UNREAD.finditer(self.text)]
        for each in STATED:
            if each.page == self.name:
                spans = [match.span() for match in pattern(each.text).finditer(self.text)]
                if not spans:
                    self.faults.append(f"{self.name}: \"{each.text}\" ({each.why}) does not stand there")
                known += spans
        for match in SHOWN.finditer(self.text):
            if not any(start <= match.start() and match.end() <= end for start, end in known):
                around = " ".join(self.text[max(0, match.start() - 50):match.end() + 40].split())
                yield self.text.count("\n", 0, match.start()) + 1, match[0], around
