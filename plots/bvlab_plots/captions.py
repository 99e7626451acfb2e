# SPDX-License-Identifier: BSD-3-Clause
"""The text below a figure: of what its points and bars are made, and what a reader has to know of it."""

import functools
import textwrap

from bvlab_plots import style
from bvlab_plots.intervals import in_words
from bvlab_plots.words import called

MANY = {"repetition": "repetitions", "seed": "seeds", "frame": "frames"}
SMALL = 6  # points, of the type
LETTER = 0.53  # of the type's size: how wide a letter is, about


def counted(column, count):
    """"3 repetitions", "2 to 8 seeds", "5 values of volume"."""
    if isinstance(count, tuple):
        count = f"{count[0]} to {count[1]}"
    return f"{count} {MANY[column]}" if column in MANY else f"{count} {called(column)} values"


def note_of(figure, points, made=""):
    """Sentences; `made` says what is drawn where it is no statistic with bars, as in a distribution."""
    attrs = points.attrs
    over = " × ".join(counted(column, count) for column, count in attrs["pooled"].items())
    head, _, bars = (made or in_words(figure, int(points["count"].max()))).partition("; ")
    sentences = [("a point for each cell: " if attrs["measured"] and not made else "") + head +
                 (f"{':' if made else ' of'} {over}" if over else "") + (f"; {bars}" if bars and figure.kind != "map" else "")]
    if attrs["timed"]:
        clock = f"{attrs['clock']} time"
        if attrs["clock"] == "processor" and attrs["of_frames"]:
            clock += f" (wall time: {', '.join(attrs['of_frames'])})"
        clock += f", each frame the fastest of {attrs['plays']} plays" if attrs["plays"] > 1 else ""
        beside = attrs["beside"]
        sentences.append(clock + (f", {beside} of {attrs['drawn']} rows measured beside other work" if beside else ""))
    if attrs["unfinished"]:
        sentences.append(f"UNFINISHED: {attrs['unfinished']}")
    return " ".join(each[0].upper() + each[1:] + "." for each in sentences)


def write(figure, drawing, text, legend=None):
    """Below the figure, under its legend where it has one; where the figure says so it is only kept, as drawing.caption."""
    drawing.caption = text
    # Whoever saves it with settings of their own has the legend and the caption, too.
    drawing.savefig = functools.partial(drawing.savefig, bbox_inches="tight")
    if figure.caption == "beside":
        return
    # Letters are fitted to pixels, so that a legend is as high as it will be only at the resolution it is saved in.
    shown, drawing.dpi = drawing.dpi, style.DPI
    drawing.draw_without_rendering()
    lowest = 0
    if legend is not None:
        lowest = legend.get_window_extent().transformed(drawing.transFigure.inverted()).y0
    drawing.dpi = shown
    inches = drawing.get_figwidth()
    lines = textwrap.fill(text, int(inches * 72 / (SMALL * LETTER)))
    unfinished = "UNFINISHED" in text
    drawing.text(0.5, lowest - 0.04 / drawing.get_figheight(), lines, ha="center", va="top", fontsize=SMALL,
                 color=style.WARNING if unfinished else "#555555", linespacing=1.1)
