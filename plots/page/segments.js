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
  const normals = [one, other].map(t => cross3(add3(t[1], t[0], -1), add3(t[2], t[0], -1))), along = cross3(...normals);
  if (dot3(along, along) === 0) return null;
  // The two points in which each triangle meets the other's plane, in their order along both planes.
  const crossings = (t, plane, normal) => {
    const height = t.map(corner => dot3(normal, add3(corner, plane[0], -1))), found = [];
    for (let k = 0; k < 3; ++k) {
      const l = (k + 1) % 3;
      if (height[k] === 0) found.push(t[k]);
      else if (height[l] !== 0 && (height[k] > 0) !== (height[l] > 0)) {
        const r = height[k] / (height[k] - height[l]);
        found.push(t[k].map((value, i) => value + r * (t[l][i] - value)));
      }
    }
    return found.map(at => [dot3(along, at), at]).sort((a, b) => a[0] - b[0]);
  };
  const a = crossings(one, other, normals[1]), b = crossings(other, one, normals[0]);
  if (a.length === 0 || b.length === 0) return null;
  const from = a[0][0] > b[0][0] ? a[0] : b[0], to = a.at(-1)[0] < b.at(-1)[0] ? a.at(-1) : b.at(-1);
  return [from[1], to[1]];
}
