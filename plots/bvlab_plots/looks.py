# SPDX-License-Identifier: BSD-3-Clause
"""One colour, marker, dash and hatch per name, for good.

A name that is not in STYLES has a look of its own, too, found from the name: see `looks`.
"""

import functools
import hashlib

import matplotlib.colors
import numpy as np

# Chosen so that lightness alone tells neighbours apart; markers, dashes and hatches do so again.
# The first three of each group, and FCL's oriented boxes.
FIRST = dict(color="#1b1b1b", marker="o", linestyle="-", hatch="")
SECOND = dict(color="#d95f0e", marker="s", linestyle="--", hatch="///")
THIRD = dict(color="#41a5c4", marker="^", linestyle="-.", hatch="...")
FCL = dict(color="#7a5195", marker="D", linestyle="--", hatch="\\\\\\")
STYLES = {
    "recursive": FIRST, "separation-list": SECOND, "deferred": THIRD,
    "published": dict(color="#8f8f8f", marker="x", linestyle=":", hatch="xx"),
    "fcl-obb": FCL,
    "fcl-obbrss": dict(color="#bc9fd1", marker="v", linestyle="-.", hatch="oo"),
    "cgal": dict(color="#3c8d40", marker="P", linestyle=":", hatch="++"),
    "fcl-kios": dict(color="#54336b", marker="d", linestyle=":", hatch="//"),
    # Convex bodies by closest features.
    "gjk": dict(color="#8f8f8f", marker="p", linestyle=":", hatch="xx"),
    "fcl-gjk": FCL,
    "libccd-gjk": dict(color="#a6761d", marker="*", linestyle=":", hatch="**"),
    "gjk-coherent": dict(color="#00796b", marker="h", linestyle="-.", hatch="..."),
    "v-clip": dict(color="#c2185b", marker="8", linestyle="--", hatch="++"),
    "recursive-both": dict(color="#6b6b6b", marker="p", linestyle="-", hatch="||"),
    "witness": dict(color="#00796b", marker="h", linestyle=(0, (1, 1)), hatch="--"),
    "by-cost": dict(color="#8c6bb1", marker="D", linestyle=":", hatch="xx"),
    "raise": dict(color="#b8860b", marker="X", linestyle=(0, (3, 1, 1, 1)), hatch="oo"),
    "margins": dict(color="#31a354", marker="v", linestyle=(0, (5, 1)), hatch="\\\\\\"),
    "adaptive": dict(color="#a50f15", marker="*", linestyle="-", hatch="++"),
    "fcl-world": FCL,
    "bullet-world": dict(color="#b0413e", marker="<", linestyle="-.", hatch="--"),
    # Ours beside libraries.
    "recommended": FIRST, "wide, from the roots": THIRD, "OPCODE": SECOND,
    "OPCODE, coherent": dict(color="#fdae6b", marker="X", linestyle=":", hatch="xx"),
    "PhysX": dict(color="#3c8d40", marker="P", linestyle="--", hatch="++"),
    "FCL, obb": FCL,
    "FCL, obbrss": dict(color="#bc9fd1", marker="v", linestyle="-.", hatch="oo"),
    "Coal, obb": dict(color="#a50f15", marker="<", linestyle=":", hatch="--"),
    "Coal, obbrss": dict(color="#e58a86", marker=">", linestyle="-.", hatch="||"),
    "Coal, rss": dict(color="#8f8f8f", marker="p", linestyle=":", hatch="//"),
    "Bullet": dict(color="#a6761d", marker="*", linestyle=":", hatch="**"),
    "ODE": dict(color="#a4c61a", marker="h", linestyle="-", hatch="OO"),
    # Volumes, where they stand beside each other.
    "sphere": FIRST, "obb": SECOND, "aabb": THIRD,
    "kdop14": dict(color="#a1d99b", marker="v", linestyle=":", hatch="xx"),
    "kdop18": dict(color="#74c476", marker="<", linestyle=":", hatch="xx"),
    "kdop26": dict(color="#238b45", marker=">", linestyle=":", hatch="xx"),
    "rss": dict(color="#8c6bb1", marker="D", linestyle="--", hatch="oo"),
    "shell": dict(color="#fdae6b", marker="P", linestyle=":", hatch="++"),
    "slab-box": dict(color="#a50f15", marker="h", linestyle="-", hatch="||"),
    # Where they are compared.
    "world": FIRST,
    # Precisions, and tests of two triangles.
    "exact": FIRST,
    "float64": dict(color="#2b7bba", marker="s", linestyle="--", hatch="///"),
    "float32": dict(color="#7fc4dd", marker="^", linestyle="-.", hatch="..."),
    "guigue-devillers": dict(color="#d95f0e", marker="X", linestyle="--", hatch="xx"),
    "moller": dict(color="#a6761d", marker="*", linestyle=":", hatch="**"),
    "bullet": dict(color="#b0413e", marker="<", linestyle="-.", hatch="--"),
    "ode": dict(color="#6f9a37", marker=">", linestyle=":", hatch="||"),
    "fcl": FCL,
    # Boxes: methods and peers.
    "blocks": FIRST, "hybrid": SECOND, "hash": THIRD,
    "sweep1": dict(color="#7a5195", marker="D", linestyle=":", hatch="\\\\\\"),
    "sweep2": dict(color="#bc9fd1", marker="v", linestyle="-.", hatch="oo"),
    "sweep3": dict(color="#c43c6b", marker="P", linestyle="--", hatch="++"),
    "sweep4": dict(color="#3c8d40", marker="X", linestyle="-", hatch="xx"),
    "sap": dict(color="#a6761d", marker="<", linestyle="--", hatch="--"),
    "dynamic-tree": dict(color="#54336b", marker="d", linestyle=":", hatch="//"),
    "sort-and-sweep": dict(color="#b0413e", marker="p", linestyle="-.", hatch="||"),
    "cgal-1000": dict(color="#8f8f8f", marker="x", linestyle=":", hatch="xx"),
    "fcl-tree": dict(color="#2b7bba", marker=">", linestyle="--", hatch="**"),
    "bullet-dbvt": dict(color="#b8860b", marker="*", linestyle=":", hatch="OO"),
    # How full a scene is, which query, how boxes move.
    "interlocked": dict(color="#b0413e", marker="o", linestyle="-", hatch=""),
    "dense": dict(color="#e69f00", marker="^", linestyle="--", hatch="///"),
    "sparse": dict(color="#41a5c4", marker="s", linestyle="-.", hatch="..."),
    "touching": FIRST,
    "contacts": dict(color="#d95f0e", marker="s", linestyle=":", hatch="///"),
    "distance": THIRD, "coherent": SECOND, "from scratch": FIRST, "drift": SECOND,
    "still": dict(color="#41a5c4", marker="^", linestyle=":", hatch="..."),
    "teleport": dict(color="#8f8f8f", marker="x", linestyle="-.", hatch="xx"),
    "part": dict(color="#54336b", marker="^", linestyle="-", hatch="//"),
}

# What looks of unknown names are put together from; no colour is too light to be seen.
COLOURS = ["#332288", "#117733", "#44aa99", "#88ccee", "#c9b14a", "#cc6677", "#aa4499", "#882255", "#e6194b", "#3cb44b",
           "#4363d8", "#f58231", "#911eb4", "#2fb5cc", "#e377c2", "#004d66", "#9a6324", "#800000", "#808000", "#000075",
           "#9e9e9e", "#a4c61a", "#5b3a1e", "#ff9da7"]
MARKERS = "os^DvPX*<>dph"
DASHES = ["-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)), (0, (6, 2, 1, 2, 1, 2))]
HATCHES = ["///", "...", "xx", "\\\\\\", "++", "oo", "||", "--", "**", "//", "\\\\", "OO", "|/", "-\\"]
FILLS = ["full", "none", "half"]  # of markers and bars
TRIES = 200  # of looks for one name
FAR = 0.22  # colours that the eye distinguishes, in the distance below


@functools.lru_cache(maxsize=None)
def lab(colour):
    """A colour in CIE Lab over 100, in which distances are those the eye sees."""
    rgb = np.array(matplotlib.colors.to_rgb(colour))
    rgb = np.where(rgb > 0.04045, ((rgb + 0.055) / 1.055) ** 2.4, rgb / 12.92)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ rgb
    x, y, z = np.cbrt(np.maximum(xyz / [0.9505, 1, 1.089], 0.0089))
    return np.array([1.16 * y - 0.16, 5 * (x - y), 2 * (y - z)])


@functools.lru_cache(maxsize=None)
def proposed(name, attempt):
    """The look that a name has by itself, the first attempt, or by which it makes way for a neighbour."""
    drawn = hashlib.sha256(f"{name}#{attempt}".encode()).digest()
    return {channel: values[place % len(values)] for place, (channel, values) in
            zip(drawn, dict(color=COLOURS, marker=MARKERS, linestyle=DASHES, hatch=HATCHES).items())}


def likeness(look, others):
    """How many of colour, marker and hatch it shares with the one of the others that it is most like, and with all."""
    shared = [int(np.linalg.norm(lab(look["color"]) - lab(other["color"])) < FAR) +
              (look["marker"] == other["marker"]) + (look["hatch"] == other["hatch"]) for other in others]
    return max(shared, default=0), sum(shared)


def looks(names):
    """A look (colour, marker, linestyle, hatch) for each name of one figure.

    Names in STYLES keep theirs. Any other gets the first of the looks drawn from its name, in whatever order
    names come, that is unlike those of its neighbours: the same in every figure, but where two would be alike.
    A strategy with a parameter ("deferred:4") is a name like any other.
    """
    names = dict.fromkeys(map(str, names))
    found = {name: STYLES[name] for name in names if name in STYLES}
    for name in sorted(set(names) - set(found)):
        unlike = (look for look in map(functools.partial(proposed, name), range(TRIES))
                  if likeness(look, found.values())[0] == 0)
        found[name] = next(unlike, None) or min((proposed(name, attempt) for attempt in range(TRIES)),
                                                key=lambda look: likeness(look, found.values()))
    return {name: found[name] for name in names}


def joint_looks(keys):
    """A look for each pair of names, the first of which says most ("deferred" of the sphere, "obb" built tightly):
    the first one's, with another filling and dashes, or, where there are many, the second one's marker."""
    keys = list(dict.fromkeys(keys))
    firsts, seconds = looks(first for first, _ in keys), list(dict.fromkeys(second for _, second in keys if second))
    markers = looks(seconds) if len(seconds) > len(FILLS) else {}
    found = {}
    for first, second in keys:
        look = dict(firsts[first], fill="full")
        if second in markers:
            look["marker"] = markers[second]["marker"]
        elif second:
            place = seconds.index(second)
            look.update(fill=FILLS[place], linestyle=[look["linestyle"], ":", (0, (4, 1))][place])
            if place and look["marker"] == "x":  # which cannot be filled
                look["marker"] = "X"
        found[first, second] = look
    return found
