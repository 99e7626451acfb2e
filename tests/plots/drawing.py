# SPDX-License-Identifier: BSD-3-Clause
"""What a test sees of figures: the names in them, and how each is drawn."""

import contextlib
import io
from pathlib import Path
from unittest import mock

from small_records import PLOTS, names_added, stranger  # noqa: F401

from bvlab_plots import style


def looks_drawn(axis):
    """How the lines, points or bars of each label look."""
    looks = {}
    for line in axis.get_lines():
        if not str(line.get_label()).startswith("_"):
            looks[line.get_label()] = look_of_line(line)
    for group in axis.containers:
        if hasattr(group, "patches") and len(group.patches):
            patch = group.patches[0]
            looks[group.get_label()] = (patch.get_facecolor(), patch.get_edgecolor(), patch.get_hatch())
        elif hasattr(group, "lines") and group.lines[0] is not None:
            looks[group.get_label()] = look_of_line(group.lines[0])
    return {label: look for label, look in looks.items() if not label.startswith("_")}


def look_of_line(line):
    return line.get_color(), line.get_marker(), line.get_linestyle(), str(line.get_markerfacecolor())


class Seen:
    """The figures that were saved while a function ran, and what it printed."""

    def __init__(self, case, run, formats=("png",)):
        self.texts, self.axes, self.paths = [], [], []
        printed, save = io.StringIO(), style.save

        def saved(figure, *arguments):
            self.texts += [text.get_text() for text in figure.findobj(lambda each: hasattr(each, "get_text"))]
            self.axes += [looks_drawn(axis) for axis in figure.axes]
            self.paths.append(Path(save(figure, *arguments)))
            for ending in formats:
                case.assertGreater(self.paths[-1].with_suffix(f".{ending}").stat().st_size, 1500)
            return self.paths[-1]

        with mock.patch.object(style, "save", saved), mock.patch.object(style, "DPI", 40), \
                mock.patch.object(style, "FORMATS", {name: style.FORMATS[name] for name in formats}), \
                contextlib.redirect_stdout(printed):
            self.result = run()
        self.printed = printed.getvalue()
        self.said = " ".join(line for line in self.printed.splitlines() if line.startswith("left out"))

    def check(self, case, names):
        """Every name is in a figure, or is said to be left out; a stranger looks like no neighbour."""
        everything = " ".join(self.texts).replace("\n", " ") + self.said
        for name in names:
            case.assertIn(str(name), everything, "left out in silence")
        for looks in self.axes:
            for label in looks:
                if "unheard-of" in label or ":" in label:
                    others = [look for other, look in looks.items() if other != label]
                    case.assertNotIn(looks[label], others, f"{label} looks like another")
