// SPDX-License-Identifier: BSD-3-Clause
// Where two triangles cross: the segment that both hold, for drawing.
'use strict';

/** The corners of a mesh's triangle in the world: nine numbers, by a pose x y z qw qx qy qz. */
function posedTriangle({ exact, triangles }, triangle, pose) {
  const [x, y, z, qw, qx, qy, qz] = pose, s = 2 / (qw * qw + qx * qx + qy * qy + qz * qz);
  return [0, 1, 2].map(k => {
    const at = 3 * triangles[3 * triangle + k], [vx, vy, vz] = exact.subarray(at, at + 3);
    // v + 2 q x (q x v + w v)
    const a = qy * vz - qz * vy + qw * vx, b = qz * vx - qx * vz + qw * vy, c = qx * vy - qy * vx + qw * vz;
    return [vx + s * (qy * c - qz * b) + x, vy + s * (qz * a - qx * c) + y, vz + s * (qx * b - qy * a) + z];
  });
}

/** Two points, or none where the triangles lie in one plane. */
function segmentOf(one, other) {
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const normalOf = t => cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const normals = [normalOf(one), normalOf(other)], along = cross(...normals);
  if (dot(along, along) === 0) return null;
  // The two points in which each triangle meets the other's plane, in their order along both planes.
  const crossings = (t, plane, normal) => {
    const height = t.map(corner => dot(normal, minus(corner, plane[0]))), found = [];
    for (let k = 0; k < 3; ++k) {
      const l = (k + 1) % 3;
      if (height[k] === 0) found.push(t[k]);
      else if (height[l] !== 0 && (height[k] > 0) !== (height[l] > 0)) {
        const r = height[k] / (height[k] - height[l]);
        found.push(t[k].map((value, i) => value + r * (t[l][i] - value)));
      }
    }
    return found.map(at => [dot(along, at), at]).sort((a, b) => a[0] - b[0]);
  };
  const a = crossings(one, other, normals[1]), b = crossings(other, one, normals[0]);
  if (a.length === 0 || b.length === 0) return null;
  const last = list => list[list.length - 1];
  const from = a[0][0] > b[0][0] ? a[0] : b[0], to = last(a)[0] < last(b)[0] ? last(a) : last(b);
  return [from[1], to[1]];
}
