# SPDX-License-Identifier: BSD-3-Clause
"""Poses of many bodies in many frames, from what others call a pose."""

from __future__ import annotations

import operator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._bvlab import _real_array

ORDERS = {"wxyz": [0, 1, 2, 3], "xyzw": [3, 0, 1, 2]}
TOLERANCE = 5e-4  # by which a matrix may miss being a rotation, unless a call says otherwise
ROUNDING = 8 * np.finfo(float).eps  # what is nearer to a rotation than this is taken as it is


def poses(positions: ArrayLike, quaternions: ArrayLike | None = None, *,
          order: str | None = None, tolerance: float | None = None) -> NDArray[np.float64]:
    """Poses as a motion trace has them: float64 (frames, objects, 7), x y z qw qx qy qz, object to world.

    poses(positions, quaternions, order="wxyz")   (frames, objects, 3) and (frames, objects, 4) real; the order of a
                                                  quaternion's numbers must be said, "wxyz" or "xyzw", since one
                                                  passes for the other. They need not be of unit length.
    poses(matrices, tolerance=5e-4)               (frames, objects, 4, 4) real: [R t; 0 0 0 1]. The pose has the
                                                  rotation that is nearest to R (of the polar decomposition). R may
                                                  change a length by at most `tolerance` of it, 5e-4 unless given:
                                                  enough for numbers of four decimals, or products in float32.

    ValueError: another shape or type, NaN, infinity, a quaternion of length 0, a matrix that is no rotation: it says
    by how much it scales, shears or mirrors.
    """
    if quaternions is None:
        if order is not None:
            raise ValueError("order: is of quaternions, and there are none")
        return _from_matrices(_array(positions, "matrices", ("frames", "objects", 4, 4)), _tolerance(tolerance))
    if tolerance is not None:
        raise ValueError("tolerance: is of matrices, and these are quaternions")
    if order not in ORDERS:
        raise ValueError(f"order: {'is needed' if order is None else f'{order!r} is unknown'}; available: "
                         + ", ".join(ORDERS))
    at = _array(positions, "positions", ("frames", "objects", 3))
    turned = _array(quaternions, "quaternions", (*at.shape[:2], 4))
    zero = ~turned.any(axis=-1)
    if zero.any():
        raise ValueError(f"quaternions: zero quaternion {_place(zero)}")
    return np.concatenate([at, turned[..., ORDERS[order]]], axis=-1)


def pairs_of(objects: int) -> NDArray[np.uint32]:
    """The pairs of so many objects in the order of all answers: (pairs, 2), (0, 1) (0, 2) ... (1, 2) ..."""
    try:
        count = operator.index(objects)
    except TypeError:
        count = -1
    if count < 0:
        raise ValueError(f"objects: a whole number from 0 on is needed, not {objects!r}")
    return np.stack(np.triu_indices(count, 1), axis=-1).astype(np.uint32)


def _array(given: ArrayLike, name: str, shape: tuple[int | str, ...]) -> NDArray[np.float64]:
    """float64, finite, of that shape, in which a name is any length."""
    axes = [(str(n), -1 if isinstance(n, str) else n) for n in shape]
    array = np.array(_real_array(given, name, axes))  # what is checked is what is kept
    wrong = ~np.isfinite(array).all(axis=tuple(range(2, array.ndim)))
    if wrong.any():
        raise ValueError(f"{name}: not a finite number {_place(wrong)}")
    return array


def _place(wrong: NDArray[np.bool_]) -> str:
    frame, thing = np.argwhere(wrong)[0]
    return f"in frame {frame}, object {thing}"


def _tolerance(given: float | None) -> float:
    try:
        tolerance = TOLERANCE if given is None else float(given)
    except (TypeError, ValueError, OverflowError):
        tolerance = -1
    if not 0 <= tolerance < 1:
        raise ValueError(f"tolerance: a number from 0 on and below 1 is needed, not {given!r}")
    return tolerance


def _from_matrices(matrices: NDArray[np.float64], tolerance: float) -> NDArray[np.float64]:
    rotation, translation = matrices[..., :3, :3].copy(), matrices[..., :3, 3]
    with np.errstate(all="ignore"):
        square = np.einsum("...ki,...kj->...ij", rotation, rotation)
        inexact = ~(np.abs(square - np.eye(3)).max(axis=(-2, -1), initial=0) < ROUNDING)
        inexact |= ~(np.linalg.det(rotation) > 0)
    left, stretch, right = np.linalg.svd(rotation[inexact])
    nearest = left @ right
    wrong = np.zeros(inexact.shape, bool)
    wrong[inexact] = (np.abs(stretch - 1) > tolerance).any(axis=-1) | (np.linalg.det(nearest) < 0)
    if wrong.any():
        raise ValueError(f"matrices: no rotation {_place(wrong)}: {_fault(rotation[wrong][0], tolerance)} "
                         f"(lengths may change by {tolerance:g} of themselves: tolerance)")
    rotation[inexact] = nearest
    wrong = (matrices[..., 3, :] != [0, 0, 0, 1]).any(axis=-1)
    if wrong.any():
        raise ValueError(f"matrices: the last row is not 0 0 0 1 {_place(wrong)}")
    return np.concatenate([translation, _quaternions(rotation)], axis=-1)


def _fault(matrix: NDArray[np.float64], tolerance: float) -> str:
    """What of a matrix is no rotation, with its size: "scaled by 2", "sheared: two of its axes are 84.3 degrees apart"."""
    left, stretch, right = np.linalg.svd(matrix)
    if stretch[0] == 0 or stretch[2] / stretch[0] < np.finfo(float).eps:
        return "flat: its determinant is 0"
    faults = []
    if np.linalg.det(left @ right) < 0:
        faults.append(f"mirrored: its determinant is {np.linalg.det(matrix):.6g}")
    if stretch[0] / stretch[2] - 1 <= 2 * tolerance:
        if (np.abs(stretch - 1) > tolerance).any():
            faults.append(f"scaled by {stretch[np.argmax(np.abs(stretch - 1))]:.6g}")
    else:
        # Along its own axes, or those of the world, it can be scaled by several factors; all else is shear.
        angles, lengths = zip(*map(_axes_of, (matrix, matrix.T)))
        best = int(np.argmax(angles))
        # Of a small shear the angles are off by as much as the lengths.
        if np.radians(90 - angles[best]) <= min(2 * tolerance, np.abs(lengths[best] - 1).max() / 4):
            faults.append(f"scaled by {', '.join(f'{each:.6g}' for each in lengths[best])} along " +
                          ["its own axes", "the world's axes"][best])
        else:
            faults.append(f"sheared: two of its axes are {angles[0]:.4g} degrees apart, and lengths change by factors of "
                          f"{stretch[2]:.6g} to {stretch[0]:.6g}")
    return " and ".join(faults)


def _axes_of(matrix: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """The least angle between two of the columns, in degrees, at most 90; and their lengths."""
    size = np.abs(matrix).max()
    lengths = np.linalg.norm(matrix / size, axis=0)
    axes = matrix / size / lengths
    cosines = np.abs(axes.T @ axes)[[0, 0, 1], [1, 2, 2]]
    return float(np.degrees(np.arccos(min(cosines.max(), 1)))), size * lengths


def _quaternions(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """w x y z by Shepperd's method: of the four ways the one that divides by the largest number."""
    trace = r[..., 0, 0] + r[..., 1, 1] + r[..., 2, 2]
    best = np.argmax(np.stack([trace, r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]], axis=-1), axis=-1)
    found = np.empty((*best.shape, 4))
    for way in range(4):
        m = r[best == way]
        q = np.empty((len(m), 4))
        i = way - 1
        if way == 0:
            q[:, 0] = 1 + trace[best == way]
            q[:, 1:] = np.stack([m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]], axis=-1)
        else:
            j, k = (i + 1) % 3, (i + 2) % 3
            q[:, 0] = m[:, k, j] - m[:, j, k]
            q[:, 1 + i] = 1 + m[:, i, i] - m[:, j, j] - m[:, k, k]
            q[:, 1 + j] = m[:, j, i] + m[:, i, j]
            q[:, 1 + k] = m[:, k, i] + m[:, i, k]
        found[best == way] = q
    return found / np.linalg.norm(found, axis=-1, keepdims=True)
