# SPDX-License-Identifier: BSD-3-Clause
"""One colour, marker, dash and hatch per name, for good.

A name that is not in STYLES has a look of its own, too, found from the name: see `looks`.
"""

import functools
import hashlib

import matplotlib.colors
import numpy as np


def look_of(color, marker, linestyle, hatch):
    return {"color": color, "marker": marker, "linestyle": linestyle, "hatch": hatch}


# The first three of each group, and FCL's oriented boxes.
FIRST = look_of("#1b1b1b", "o", "-", "")
SECOND = look_of("#d95f0e", "s", "--", "///")
THIRD = look_of("#41a5c4", "^", "-.", "...")
FCL = look_of("#7a5195", "D", "--", "\\\\\\")
# Chosen so that lightness alone distinguishes neighbours; markers, dashes and hatches do so again.
STYLES = {
    "recursive": FIRST, "separation-list": SECOND, "deferred": THIRD, "published": look_of("#8f8f8f", "x", ":", "xx"),
    "fcl-obb": FCL, "fcl-obbrss": look_of("#bc9fd1", "v", "-.", "oo"), "cgal": look_of("#3c8d40", "P", ":", "++"),
    "fcl-kios": look_of("#54336b", "d", ":", "//"),
    # Convex bodies by closest features.
    "gjk": look_of("#8f8f8f", "p", ":", "xx"), "fcl-gjk": FCL, "libccd-gjk": look_of("#a6761d", "*", ":", "**"),
    "gjk-coherent": look_of("#00796b", "h", "-.", "..."), "v-clip": look_of("#c2185b", "8", "--", "++"),
    "recursive-both": look_of("#6b6b6b", "p", "-", "||"), "witness": look_of("#00796b", "h", (0, (1, 1)), "--"),
    "by-cost": look_of("#8c6bb1", "D", ":", "xx"), "raise": look_of("#b8860b", "X", (0, (3, 1, 1, 1)), "oo"),
    "margins": look_of("#31a354", "v", (0, (5, 1)), "\\\\\\"), "adaptive": look_of("#a50f15", "*", "-", "++"), "fcl-world": FCL,
    "bullet-world": look_of("#b0413e", "<", "-.", "--"),
    # Ours beside libraries.
    "recommended": FIRST, "wide, from the roots": THIRD, "OPCODE": SECOND,
    "OPCODE, coherent": look_of("#fdae6b", "X", ":", "xx"), "PhysX": look_of("#3c8d40", "P", "--", "++"), "FCL, obb": FCL,
    "FCL, obbrss": look_of("#bc9fd1", "v", "-.", "oo"), "Coal, obb": look_of("#a50f15", "<", ":", "--"),
    "Coal, obbrss": look_of("#e58a86", ">", "-.", "||"), "Coal, rss": look_of("#8f8f8f", "p", ":", "//"),
    "Bullet": look_of("#a6761d", "*", ":", "**"), "ODE": look_of("#a4c61a", "h", "-", "OO"),
    # Volumes, where they stand beside each other.
    "sphere": FIRST, "obb": SECOND, "aabb": THIRD, "kdop14": look_of("#a1d99b", "v", ":", "xx"),
    "kdop18": look_of("#74c476", "<", ":", "xx"), "kdop26": look_of("#238b45", ">", ":", "xx"),
    "rss": look_of("#8c6bb1", "D", "--", "oo"), "shell": look_of("#fdae6b", "P", ":", "++"),
    "slab-box": look_of("#a50f15", "h", "-", "||"),
    # Where they are compared.
    "world": FIRST,
    # Precisions, and tests of two triangles.
    "exact": FIRST, "float64": look_of("#2b7bba", "s", "--", "///"), "float32": look_of("#7fc4dd", "^", "-.", "..."),
    "guigue-devillers": look_of("#d95f0e", "X", "--", "xx"), "moller": look_of("#a6761d", "*", ":", "**"),
    "bullet": look_of("#b0413e", "<", "-.", "--"), "ode": look_of("#6f9a37", ">", ":", "||"), "fcl": FCL,
    # Boxes: methods and peers.
    "blocks": FIRST, "hybrid": SECOND, "hash": THIRD, "sweep1": look_of("#7a5195", "D", ":", "\\\\\\"),
    "sweep2": look_of("#bc9fd1", "v", "-.", "oo"), "sweep3": look_of("#c43c6b", "P", "--", "++"),
    "sweep4": look_of("#3c8d40", "X", "-", "xx"), "sap": look_of("#a6761d", "<", "--", "--"),
    "dynamic-tree": look_of("#54336b", "d", ":", "//"), "sort-and-sweep": look_of("#b0413e", "p", "-.", "||"),
    "cgal-1000": look_of("#8f8f8f", "x", ":", "xx"), "fcl-tree": look_of("#2b7bba", ">", "--", "**"),
    "bullet-dbvt": look_of("#b8860b", "*", ":", "OO"),
    # How full a scene is, which query, how boxes move.
    "interlocked": look_of("#b0413e", "o", "-", ""), "dense": look_of("#e69f00", "^", "--", "///"),
    "sparse": look_of("#41a5c4", "s", "-.", "..."), "touching": FIRST, "contacts": look_of("#d95f0e", "s", ":", "///"),
    "distance": THIRD, "coherent": SECOND, "from scratch": FIRST, "drift": SECOND,
    "still": look_of("#41a5c4", "^", ":", "..."), "teleport": look_of("#8f8f8f", "x", "-.", "xx"),
    "part": look_of("#54336b", "^", "-", "//"),
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
