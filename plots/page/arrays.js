// SPDX-License-Identifier: BSD-3-Clause
// Arrays that stand in a page as text; which mesh a body has, and how pairs are numbered: (0,1) (0,2) ... (1,2) ...
'use strict';

const bytesOf = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
const floatsOf = text => new Float32Array(bytesOf(text).buffer);
const doublesOf = text => new Float64Array(bytesOf(text).buffer);
const wholesOf = text => new Uint32Array(bytesOf(text).buffer);

function bodiesOf(objects, meshes) {
  const meshIndexOf = i => i % meshes.length, meshOf = i => meshes[meshIndexOf(i)];
  return {
    objects, meshes, meshOf, meshIndexOf,
    triangles: Array.from({ length: objects }, (_, i) => meshOf(i).triangleCount).reduce((a, b) => a + b, 0),
    pairCount: objects * (objects - 1) / 2,
    pairOf: p => {
      let i = 0;
      for (let row = objects - 1; p >= row; p -= row--) ++i;
      return [i, i + 1 + p];
    },
    numberOf: (i, j) => {
      if (i > j) [i, j] = [j, i];
      return i * (2 * objects - i - 1) / 2 + j - i - 1;
    },
  };
}
