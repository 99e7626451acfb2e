# SPDX-License-Identifier: BSD-3-Clause
"""What of bvlab is C++."""

from collections.abc import Callable, Collection
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Protocol, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

class HasFaces(Protocol):
    """As trimesh's meshes."""

    @property
    def vertices(self) -> ArrayLike: ...
    @property
    def faces(self) -> ArrayLike: ...

class Mesh:
    def __init__(self, vertices: ArrayLike | HasFaces, faces: ArrayLike | None = None) -> None: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    def __len__(self) -> int: ...

Meshes = Mesh | HasFaces | Collection[Mesh | HasFaces]

class Result:
    @property
    def answers(self) -> NDArray[Any] | None: ...
    @property
    def totals(self) -> dict[str, Any]: ...
    @property
    def nearest(self) -> NDArray[np.void] | None: ...
    @property
    def pairs(self) -> NDArray[np.uint32] | None: ...
    @property
    def series(self) -> NDArray[np.void] | None: ...
    @property
    def frame_seconds(self) -> NDArray[np.float64] | None: ...
    @property
    def seconds(self) -> float: ...
    @property
    def build_seconds(self) -> float: ...
    @property
    def first_seconds(self) -> float: ...
    @property
    def n_u(self) -> int | None: ...
    @property
    def n_v(self) -> int | None: ...
    @property
    def n_p(self) -> int | None: ...
    @property
    def front(self) -> float | None: ...

class World:
    def __init__(
        self,
        meshes: Meshes = (),
        *,
        objects: int | None = None,
        volume: str | None = None,
        strategy: str | None = None,
        fan_out: int | None = None,
        frame: str | None = None,
        kernel: str | None = None,
        configuration: str | None = None,
        build: str | None = None,
        leaf_size: int | None = None,
        fit: str | None = None,
        precision: str = ...,
        threads: int = 1,
        pairs: ArrayLike | None = None,
        without: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> None: ...
    def move(self, object: int | ArrayLike, pose: ArrayLike) -> None: ...
    def add(self, mesh: Mesh | HasFaces, pose: ArrayLike | None = None) -> int: ...
    def remove(self, object: int) -> None: ...
    def update(self) -> None: ...
    def timed_steps(self, objects: ArrayLike, poses: ArrayLike) -> NDArray[np.float64]: ...
    def touching(self) -> NDArray[np.uint32]: ...
    def contacts(self) -> NDArray[np.uint32]: ...
    @overload
    def distances(
        self, below: float, *, nearest: Literal[False] = False
    ) -> tuple[NDArray[np.uint32], NDArray[np.float64]]: ...
    @overload
    def distances(
        self, below: float, *, nearest: Literal[True]
    ) -> tuple[NDArray[np.uint32], NDArray[np.float64], NDArray[np.void]]: ...
    @property
    def near(self) -> int: ...
    @property
    def queried(self) -> int: ...
    def __len__(self) -> int: ...

def read(path: str | PathLike[str], *, scale: float = 1.0) -> Mesh: ...
def _read_parts(path: str | PathLike[str], scale: float) -> list[tuple[Mesh, str, NDArray[np.float64]]]: ...
def named_mesh(name: str, polygons: int = 500) -> Mesh: ...
def replay(
    meshes: Meshes,
    poses: ArrayLike,
    *,
    volume: str | None = None,
    strategy: str | None = None,
    query: str = ...,
    fan_out: int | None = None,
    frame: str | None = None,
    kernel: str | None = None,
    configuration: str | None = None,
    build: str | None = None,
    leaf_size: int | None = None,
    fit: str | None = None,
    precision: str = ...,
    relative_error: float = ...,
    count: bool = False,
    threads: int = 1,
    answers: bool = True,
    series: bool = False,
    frame_seconds: bool = False,
    nearest: bool = False,
    pairs: ArrayLike | None = None,
    without: ArrayLike | None = None,
    groups: ArrayLike | None = None,
    broad_phase: str = "auto",
) -> Result: ...
def boxes(
    trace: ArrayLike,
    *,
    method: str = ...,
    coherent: bool = True,
    precision: str = ...,
    threads: int = 1,
    answers: bool = True,
) -> Result: ...
def predict(
    meshes: Meshes,
    poses: ArrayLike,
    *,
    volume: str = ...,
    query: str = ...,
    fan_out: int | None = ...,
    frame: str | None = ...,
    build: str = ...,
    leaf_size: int = ...,
    fit: str = ...,
    relative_error: float = ...,
    stride: int | None = ...,
    window: int | None = ...,
) -> dict[str, Any]: ...
def names(kind: str) -> dict[str, str]: ...
def kinds() -> list[str]: ...
def _real_array(given: ArrayLike, name: str, axes: list[tuple[str, int]]) -> NDArray[np.float64]: ...
def run_text(
    text: str,
    file: bytes,
    record: bytes,
    counts: bool,
    threads: int,
    progress: Callable[[int, int], object] | None,
) -> Path: ...
