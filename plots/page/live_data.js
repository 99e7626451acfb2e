// SPDX-License-Identifier: BSD-3-Clause
// What plots/live wrote into the page, and what the scene draws of it: one frame, whose poses change.
'use strict';

const data = (() => {
  const read = JSON.parse(document.getElementById('data').textContent);
  const meshes = read.meshes.map(({ name, vertices, triangles }) => {
    const exact = doublesOf(vertices), corners = wholesOf(triangles);
    return { name, exact, vertices: Float32Array.from(exact), triangles: corners, triangleCount: corners.length / 3,
      children: new Uint32Array(1), depths: new Uint16Array(1), deepest: 0, volumes: new Float32Array(0), numbers: 0 };
  });
  const objects = read.bodies, motion = doublesOf(read.motion), frames = motion.length / (7 * objects) || 0;
  // Of the motion, what the camera is to see at first: as it is drawn, from where the first body begins.
  const seen = 8, viewed = new Float32Array(7 * objects * seen);
  for (let k = 0; k < viewed.length; ++k)
    viewed[k] = motion[7 * objects * Math.round(Math.floor(k / (7 * objects)) * (frames - 1) / (seen - 1)) + k % (7 * objects)] - (k % 7 < 3 ? motion[k % 7] : 0);
  return {
    ...read, ...bodiesOf(objects, meshes), motion,
    motionFrames: frames, frames: 1, poses: new Float32Array(7 * objects), viewed: { poses: viewed, frames: seen }, drawn_as: '',
    frameOf: f => motion.subarray(7 * objects * f, 7 * objects * (f + 1)),
  };
})();
data.poses.set(data.frameOf(0));
