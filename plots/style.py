# SPDX-License-Identifier: BSD-3-Clause
"""One colour, marker and hatch per name, for good; figures legible in print and in greyscale."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# Chosen so that lightness alone tells neighbours apart; markers, dashes and hatches do so again.
STYLES = {
    "recursive": dict(color="#1b1b1b", marker="o", linestyle="-", hatch=""),
    "separation-list": dict(color="#d95f0e", marker="s", linestyle="--", hatch="///"),
    "deferred": dict(color="#41a5c4", marker="^", linestyle="-.", hatch="..."),
    "published": dict(color="#8f8f8f", marker="x", linestyle=":", hatch="xx"),
    "fcl-obb": dict(color="#7a5195", marker="D", linestyle="--", hatch="\\\\\\"),
    "fcl-obbrss": dict(color="#bc9fd1", marker="v", linestyle="-.", hatch="oo"),
    "cgal": dict(color="#3c8d40", marker="P", linestyle=":", hatch="++"),
    "fcl-kios": dict(color="#54336b", marker="d", linestyle=":", hatch="//"),
    # Convex bodies by closest features.
    "gjk": dict(color="#8f8f8f", marker="p", linestyle=":", hatch="xx"),
    "fcl-gjk": dict(color="#7a5195", marker="D", linestyle="--", hatch="\\\\\\"),
    "libccd-gjk": dict(color="#a6761d", marker="*", linestyle=":", hatch="**"),
    "gjk-coherent": dict(color="#00796b", marker="h", linestyle="-.", hatch="..."),
    "v-clip": dict(color="#c2185b", marker="8", linestyle="--", hatch="++"),
    "recursive-both": dict(color="#6b6b6b", marker="p", linestyle="-", hatch="\\\\"),
    "by-cost": dict(color="#8c6bb1", marker="D", linestyle=":", hatch="xx"),
    "raise": dict(color="#b8860b", marker="X", linestyle=(0, (3, 1, 1, 1)), hatch="oo"),
    "margins": dict(color="#31a354", marker="v", linestyle=(0, (5, 1)), hatch="\\\\\\"),
    "adaptive": dict(color="#de2d26", marker="*", linestyle="-", hatch="++"),
    "fcl-world": dict(color="#7a5195", marker="D", linestyle="--", hatch="\\\\\\"),
    "bullet-world": dict(color="#b0413e", marker="<", linestyle="-.", hatch="--"),
    # Volumes, where they stand beside each other.
    "sphere": dict(color="#1b1b1b", marker="o", linestyle="-", hatch=""),
    "obb": dict(color="#d95f0e", marker="s", linestyle="--", hatch="///"),
    "aabb": dict(color="#41a5c4", marker="^", linestyle="-.", hatch="..."),
    "kdop14": dict(color="#c7e9c0", marker="v", linestyle=":", hatch="xx"),
    "kdop18": dict(color="#74c476", marker="v", linestyle=":", hatch="xx"),
    "kdop26": dict(color="#238b45", marker="v", linestyle=":", hatch="xx"),
    "rss": dict(color="#8c6bb1", marker="D", linestyle="--", hatch="oo"),
    "shell": dict(color="#fdae6b", marker="P", linestyle=":", hatch="++"),
    # How K-DOPs are posed.
    "realigned": dict(color="#1b1b1b", marker="o", linestyle="-", hatch=""),
    "corners": dict(color="#d95f0e", marker="s", linestyle="--", hatch="///"),
    "hull": dict(color="#41a5c4", marker="^", linestyle="-.", hatch="..."),
    # Precisions, and tests of two triangles.
    "exact": dict(color="#1b1b1b", marker="o", linestyle="-", hatch=""),
    "float64": dict(color="#2b7bba", marker="s", linestyle="--", hatch="///"),
    "float32": dict(color="#7fc4dd", marker="^", linestyle="-.", hatch="..."),
    "guigue-devillers": dict(color="#d95f0e", marker="X", linestyle="--", hatch="xx"),
    "moller": dict(color="#a6761d", marker="*", linestyle=":", hatch="**"),
    "bullet": dict(color="#b0413e", marker="<", linestyle="-.", hatch="--"),
    "ode": dict(color="#6f9a37", marker=">", linestyle=":", hatch="||"),
    "fcl": dict(color="#7a5195", marker="D", linestyle="--", hatch="\\\\\\"),
}

DENSITY_COLOURS = {"interlocked": "#b0413e", "dense": "#e69f00", "sparse": "#41a5c4"}

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


def line_style(name):
    """Keywords for plot: colour, dashes."""
    style = STYLES[name]
    return dict(color=style["color"], linestyle=style["linestyle"])


def marker_style(name):
    """Keywords for plot without a line: colour, marker."""
    style = STYLES[name]
    return dict(color=style["color"], marker=style["marker"], linestyle="none")


def world_style(variant):
    """Keywords for plot: a peer by its own name, ours ("sphere deferred") by its strategy's, hollow
    where the volume is not the sphere."""
    volume, _, strategy = variant.partition(" ")
    style = STYLES.get(strategy.partition(":")[0], STYLES["published"]) if strategy else STYLES[volume]
    hollow = dict(markerfacecolor="white") if strategy and volume != "sphere" else {}
    return dict(color=style["color"], marker=style["marker"], linestyle=style["linestyle"], **hollow)


def bar_style(name):
    """Keywords for bar: fill, hatch, edge."""
    style = STYLES[name]
    return dict(color=style["color"], hatch=style["hatch"], edgecolor="white", linewidth=0.5)


def legend_below(figure, axis):
    """One row under the whole figure, of what is drawn in one of its axes."""
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=len(labels), frameon=False,
                  bbox_to_anchor=(0.5, -0.06))


def save(figure, folder, name):
    """Writes <folder>/<name>.pdf and .png, the same bytes for the same record."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.pdf", metadata={"CreationDate": None})
    figure.savefig(folder / f"{name}.png", dpi=200, metadata={"Software": None})
    plt.close(figure)
    return folder / f"{name}.png"
