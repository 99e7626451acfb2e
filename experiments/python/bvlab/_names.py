# SPDX-License-Identifier: BSD-3-Clause
"""The names that there are, each with what it is: those of the program, from the program."""

from ._bvlab import names


def volumes() -> dict[str, str]:
    """Bounding volumes: each name with what it is."""
    return names("volumes")


def strategies() -> dict[str, str]:
    """How much of the last answer is used again: each name with what it is."""
    return names("strategies")


def frames() -> dict[str, str]:
    """Where volumes are compared: each name with what it is."""
    return names("frames")


def kernels() -> dict[str, str]:
    """How the lanes of a register are filled: each name with what it is."""
    return names("kernels")


def queries() -> dict[str, str]:
    """What is asked of a pair: each name with what it is."""
    return names("queries")


def methods() -> dict[str, str]:
    """Broad-phase methods, for boxes: each name with what it is."""
    return names("methods")


def configurations() -> dict[str, str]:
    """Names for volume, tree, strategy, build, fit and leaf size at once, with what they are."""
    return names("configurations")


def builds() -> dict[str, str]:
    """How hierarchies are built: each name with what it is."""
    return names("builds")


def precisions() -> dict[str, str]:
    """Tests of triangle against triangle: each name with what it is."""
    return names("precisions")


def parameters() -> dict[str, str]:
    """What a definition can set: each name with what it is and its default."""
    return names("parameters")


def formula_meshes() -> dict[str, str]:
    """Meshes that are made by formula, for named_mesh and definitions: each name with what it is."""
    return names("meshes")


def peers() -> dict[str, str]:
    """Other libraries that a definition can run on the same work: each name with what it is."""
    return names("peers")
