# SPDX-License-Identifier: BSD-3-Clause
"""Files that hold several meshes."""

from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._bvlab import Mesh, _read_parts


class Part(NamedTuple):
    """One of the parts of a file."""

    mesh: Mesh  # in the part's own frame
    name: str  # empty where the file has none
    pose: NDArray[np.float64]  # x y z qw qx qy qz, the part's frame to the file's


def read_parts(path: str | PathLike[str], *, scale: float = 1.0) -> list[Part]:
    """The parts of a file, in its order: nodes of a scene (glTF, DAE, 3MF, ...), objects and groups of an OBJ, solids
    of an STL; other files have one.

    Nodes that show the same mesh share it. What a node's transformation has beside a rotation and a translation is in
    the mesh, so that posed meshes are what `read` gives, up to rounding. Units, axes, `scale` and errors: as `read`."""
    return [Part(*part) for part in _read_parts(path, scale)]
