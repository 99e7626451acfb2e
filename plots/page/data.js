// SPDX-License-Identifier: BSD-3-Clause
// What the program wrote into the page, as typed arrays. Its scene_page.cpp is the other end.
'use strict';

/** Sets that change from frame to frame (see sets_over_time.hpp): one sorted array for each frame. */
function setsOverTime(text, frames) {
  const bytes = bytesOf(text), sets = [];
  let at = 0, last = [];
  const next = () => {
    let value = 0;
    for (let place = 1; ; place *= 128) {
      const byte = bytes[at++];
      value += (byte & 127) * place;
      if (byte < 128) return value;
    }
  };
  for (let f = 0; f < frames; ++f) {
    const changed = [];
    for (let count = next(), number = 0; count > 0; --count) changed.push(number += next());
    if (changed.length > 0) last = symmetricDifference(last, changed);
    sets.push(last);
  }
  return sets;
}

function symmetricDifference(a, b) {
  const result = [];
  let i = 0, j = 0;
  while (i < a.length || j < b.length) {
    if (j === b.length || a[i] < b[j]) result.push(a[i++]);
    else if (i === a.length || b[j] < a[i]) result.push(b[j++]);
    else ++i, ++j;
  }
  return result;
}

/** How far each node is from the root; children come after their parent. */
function depthsOf(children) {
  const depths = new Uint16Array(children.length);
  children.forEach((first, i) => {
    if (first > 0) depths[first] = depths[first + 1] = depths[i] + 1;
  });
  return depths;
}

const data = (() => {
  const read = JSON.parse(document.getElementById('data').textContent);
  const { frames, objects } = read;
  const meshes = Object.values(read.meshes).map(mesh => {
    const children = wholesOf(mesh.children), depths = depthsOf(children);
    return {
      name: mesh.name, triangleCount: mesh.triangle_count, numbers: mesh.numbers,
      vertices: floatsOf(mesh.vertices), triangles: wholesOf(mesh.triangles),
      children, depths, deepest: depths.reduce((a, b) => Math.max(a, b), 0),
      volumes: floatsOf(mesh.volumes),
    };
  });
  return {
    ...read, ...bodiesOf(objects, meshes),
    poses: floatsOf(read.poses), series: wholesOf(read.series),
    touching: setsOverTime(read.touching, frames),
    leftOut: Object.values(read.left_out),
    keepsFronts: Object.keys(read.fronts).length > 0,
    /** Of a pair: for each frame twice the node, and one more for the second body; or nothing. */
    front: (() => {
      let known = -1, sets = null;
      return p => {
        if (p !== known) sets = p in read.fronts ? setsOverTime(read.fronts[p], frames) : null;
        known = p;
        return sets;
      };
    })(),
  };
})();
