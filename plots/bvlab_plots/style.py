# SPDX-License-Identifier: BSD-3-Clause
"""How figures look: legible in print and in greyscale; names have the looks of looks.py."""

import contextlib
import io
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bvlab_plots.looks import STYLES, joint_looks, looks  # noqa: F401
from bvlab_plots.refused import Refused

DPI = 200  # of images
WIDTHS = {"column": 3.4, "page": 7.0}  # inches, of a paper of two columns
WARNING = "#b0413e"
FORMATS = {"pdf": dict(CreationDate=None), "png": dict(Software=None)}  # and what would differ from run to run

plt.rcParams.update({
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.labelsize": 9,
    "legend.fontsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "figure.dpi": 150,
    "pdf.fonttype": 42,
    "savefig.bbox": "tight",
    "hatch.linewidth": 0.6,
})


@contextlib.contextmanager
def settings(given):
    """With the settings of a file, or of a style that matplotlib knows by this name, over those above."""
    with matplotlib.rc_context():
        if given in plt.style.available:
            plt.style.use(given)
        elif given and not Path(given).is_file():
            raise Refused(f"--style {given}: no such file, and no style of matplotlib's")
        elif given:
            try:
                of_file = matplotlib.rc_params_from_file(given, fail_on_error=True, use_default_template=False)
                plt.rcParams.update({key: value for key, value in of_file.items() if key != "backend"})
            except (OSError, ValueError, KeyError) as fault:
                raise Refused(f"--style {given}: {fault}".replace("\n", " ")) from None
        yield


def subplots(lines, columns, figsize, **keywords):
    """As plt.subplots, for files: whatever backend is set, and whether or not there is a display."""
    figure = Figure(figsize=figsize, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(lines, columns, squeeze=False, **keywords)


def line_style(look):
    """Keywords for plot: colour, dashes."""
    return dict(color=look["color"], linestyle=look["linestyle"])


def marker_style(look):
    """Keywords for plot without a line: colour, marker, its filling."""
    return dict(point_style(look), linestyle="none")


def point_style(look):
    """Keywords for plot: colour, dashes, marker, its filling."""
    fill = {"none": "white", "half": lighter(look["color"])}.get(look.get("fill"), look["color"])
    return dict(color=look["color"], linestyle=look["linestyle"], marker=look["marker"], markerfacecolor=fill)


def bar_style(look):
    """Keywords for bar: fill, hatch, edge."""
    if look.get("fill", "full") == "full":
        return dict(facecolor=look["color"], hatch=look["hatch"], edgecolor="white", linewidth=0.5)
    colour = "white" if look["fill"] == "none" else lighter(look["color"])
    return dict(facecolor=colour, hatch=look["hatch"], edgecolor=look["color"], linewidth=0.8)


def lighter(colour):
    return tuple(0.5 + 0.5 * channel for channel in matplotlib.colors.to_rgb(colour))


def legend_below(figure, handles, labels, **keywords):
    """Under the whole figure, in as many columns as its width holds."""
    for columns in range(len(labels), 0, -1):
        legend = figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=columns,
                               frameon=False, columnspacing=1.2, handlelength=2.4, borderaxespad=0.2, **keywords)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return legend
        legend.remove()
    return None


def labelled(axes):
    """Handles and labels of several axes, each label once."""
    found = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            found.setdefault(label, handle)
    return list(found.values()), list(found)


def save(figure, folder, name, formats=None):
    """Writes <folder>/<name>.pdf and .png, the same bytes for the same record, each whole or not at all."""
    written = [ending for ending in FORMATS if formats is None or ending in formats]
    for ending in written:
        # In memory first: where a disk is full, matplotlib's own handling of the fault fails, too.
        drawn = io.BytesIO()
        figure.savefig(drawn, format=ending, dpi=DPI, metadata=FORMATS[ending])
        path = write(folder, f"{name}.{ending}", drawn.getvalue())
    plt.close(figure)
    return path


def write(folder, name, content):
    """A file of text or bytes, whole or not at all."""
    path, unfinished = Path(folder) / name, Path(folder) / f".{name}.unfinished"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.write_bytes(content.encode() if isinstance(content, str) else content)
        unfinished.replace(path)
    except OSError as fault:  # of a file that is written to, it does not say the name
        raise OSError(fault.errno, fault.strerror, str(path)) from None
    finally:
        unfinished.unlink(missing_ok=True)
    return path
