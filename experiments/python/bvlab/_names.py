# SPDX-License-Identifier: BSD-3-Clause
"""Names and descriptions of all that can be chosen, as the program lists them."""

from collections.abc import Callable

from ._bvlab import names


def _listing(function: str, described: str, kind: str = "") -> Callable[[], dict[str, str]]:
    """The function of that name, which gives the names of a kind: where none is given, of the kind called as it is."""
    def listed() -> dict[str, str]:
        return names(kind or function)

    listed.__name__ = listed.__qualname__ = function
    listed.__doc__ = f"{described}: descriptions."
    return listed


volumes = _listing("volumes", "Bounding volumes, by name")
strategies = _listing("strategies", "Strategies, which reuse the last frame's traversal, by name")
frames = _listing("frames", "Frames in which volumes are compared, by name")
kernels = _listing("kernels", "Kernels, which fill the lanes of a register, by name")
queries = _listing("queries", "Queries of a pair, by name")
methods = _listing("methods", "Broad-phase methods, by name")
configurations = _listing("configurations", "Configurations of volume, tree, strategy, build, fit and leaf size, by name")
builds = _listing("builds", "Ways to build a hierarchy, by name")
precisions = _listing("precisions", "Tests of triangle against triangle, by name")
parameters = _listing("parameters", "Parameters of a definition, by name, with defaults")
studies = _listing("studies", "Kinds of studies, which are no product of replays, by name")
study_parameters = _listing("study_parameters", 'Parameters of studies, by "kind.name", with bounds and defaults', "study-parameters")
formula_meshes = _listing("formula_meshes", "Meshes made by formula, for named_mesh and definitions, by name", "meshes")
peers = _listing("peers", "Other libraries that a definition can run, by name")
