#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's text and figures, from records.

usage: generate.py RECORDS OUT

main.tex is a template: a number stands in it as <<function.key:format>>, as in the pages of plots/texts, and is computed by
the same function (plots/quotes). OUT gets main.tex with the numbers in place, and figures/.
"""

import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "plots")]
import quotes  # noqa: E402, F401
import quoting  # noqa: E402
from bvlab_plots.refused import Refused  # noqa: E402

MARKS = [
    (r"\[([^]]*)\]\([^)]*\)", r"\1"),
    (r"&kappa;", r"$\\kappa$"),
    (r"N<sub>v</sub>", r"$N_v$"),
    (r"`([^`]*)`", r"\\emph{\1}"),
    (r"([%&_#])", r"\\\1"),
    (r"(?<=\d) (\d{3})\b", r"\\,\1"),
]


def latex(text):
    """What a page says, as LaTeX."""
    for mark, instead in MARKS:
        text = re.sub(mark, instead, text)
    return text


class Paper(quoting.Page):
    """The template, with what functions give written as LaTeX."""

    def filled(self, place):
        name, key, _ = place.groups()
        text = super().filled(place)
        if text == place[0]:
            return text
        value = quoting.numbers(name, self.records)[0][key]
        if not quoting.is_table(value):
            return latex(text)
        return "\n".join(" & ".join(latex(str(cell)) for cell in row) + r" \\" for row in value)


def text(records=quoting.RECORDS):
    return Paper("paper/main.tex", quoting.PAPER.read_text(), Path(records))


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: generate.py RECORDS OUT")
    records, out = map(Path, sys.argv[1:])
    paper = text(records)
    written = paper.written()
    for fault in paper.faults:
        print(f"generate.py: {fault}", file=sys.stderr)
    if paper.faults:
        sys.exit(2)
    out.mkdir(parents=True, exist_ok=True)
    (out / "main.tex").write_text(written)
    import drawings  # pylint: disable=import-outside-toplevel

    try:
        drawings.draw(records, out / "figures")
    except Refused as fault:
        sys.exit(f"generate.py: {fault}")


if __name__ == "__main__":
    main()
