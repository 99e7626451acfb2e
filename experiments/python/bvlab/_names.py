# SPDX-License-Identifier: BSD-3-Clause
"""Names and descriptions of all that can be chosen, as the program lists them."""

from ._bvlab import names


def volumes() -> dict[str, str]:
    """Bounding volumes, by name: descriptions."""
    return names("volumes")


def strategies() -> dict[str, str]:
    """Strategies, which reuse the last frame's traversal, by name: descriptions."""
    return names("strategies")


def frames() -> dict[str, str]:
    """Frames in which volumes are compared, by name: descriptions."""
    return names("frames")


def kernels() -> dict[str, str]:
    """Kernels, which fill the lanes of a register, by name: descriptions."""
    return names("kernels")


def queries() -> dict[str, str]:
    """Queries of a pair, by name: descriptions."""
    return names("queries")


def methods() -> dict[str, str]:
    """Broad-phase methods, by name: descriptions."""
    return names("methods")


def configurations() -> dict[str, str]:
    """Configurations of volume, tree, strategy, build, fit and leaf size, by name: descriptions."""
    return names("configurations")


def builds() -> dict[str, str]:
    """Ways to build a hierarchy, by name: descriptions."""
    return names("builds")


def precisions() -> dict[str, str]:
    """Tests of triangle against triangle, by name: descriptions."""
    return names("precisions")


def parameters() -> dict[str, str]:
    """Parameters of a definition, by name: descriptions with defaults."""
    return names("parameters")


def studies() -> dict[str, str]:
    """Kinds of studies, which are no product of replays, by name: descriptions."""
    return names("studies")


def study_parameters() -> dict[str, str]:
    """Parameters of studies, by "kind.name": descriptions with bounds and defaults."""
    return names("study-parameters")


def formula_meshes() -> dict[str, str]:
    """Meshes made by formula, for named_mesh and definitions, by name: descriptions."""
    return names("meshes")


def peers() -> dict[str, str]:
    """Other libraries that a definition can run, by name: descriptions."""
    return names("peers")
