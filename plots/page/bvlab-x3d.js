// SPDX-License-Identifier: BSD-3-Clause
// bvlab in an X3D browser: parts of a scene in x3dom, and which of them touch.
//
//   const contact = await bvlabX3d(x3d, engine, { colour: '1 0 0', onChange(pairs) {} });
//
// x3d      the <x3d> element, after x3dom has read its scene
// engine   of engineFrom (engine.js), without meshes as yet
// A part is an outermost Transform that has triangles: it moves as one, by sensors, interpolators or scripts. In every
// frame in which one has moved, the engine tests all; those that touch take the colour, and their own one after that.
//   contact.parts      the Transform elements; their numbers are those of the pairs
//   contact.touching   [i, j] for each pair that touches, i < j, as of the last frame; `onChange` when it changes
//   contact.detach()   ends it
// It refuses, by an Error whose message is a sentence, a scene without two parts, and one that is too large.
'use strict';

async function bvlabX3d(x3d, engine, { colour = '1 0 0', onChange = () => {}, mostTriangles = 200000 } = {}) {
  // Matrices of x3dom are rows _00 .. _33.
  const rowsOf = m => [[m._00, m._01, m._02, m._03], [m._10, m._11, m._12, m._13], [m._20, m._21, m._22, m._23]];
  const node = element => element._x3domNode;
  const shapesOf = part => [...part.querySelectorAll('shape')].filter(shape => node(shape)?._cf.geometry.node);
  const outermost = [...x3d.querySelectorAll('transform')].filter(part => !part.parentElement.closest('transform') && shapesOf(part).length > 0);
  if (outermost.length < 2) throw Error('This scene has fewer than two parts: outermost Transforms that hold shapes.');

  const tooMany = () => Error(`This scene has more than ${mostTriangles.toLocaleString('en')} triangles: too many to ask in every frame here.`);
  const lengthOf = (rows, column) => Math.hypot(rows[0][column], rows[1][column], rows[2][column]) || 1;
  /** The pose of a part: x y z qw qx qy qz, from its matrix without its scale. */
  function poseOf(part) {
    const rows = rowsOf(node(part).getCurrentTransform()), scale = [0, 1, 2].map(k => lengthOf(rows, k));
    const r = rows.map(row => row.slice(0, 3).map((x, k) => x / scale[k]));
    // The largest of four numbers first (Shepperd): none of the others is divided by a small one.
    const [a, b, c] = [r[0][0], r[1][1], r[2][2]], sums = [a + b + c, a - b - c, b - a - c, c - a - b];
    const k = sums.indexOf(Math.max(...sums)), s = 2 * Math.sqrt(1 + sums[k]);
    const minus = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]], plus = [r[2][1] + r[1][2], r[0][2] + r[2][0], r[1][0] + r[0][1]];
    const q = [s / 4, 0, 0, 0];
    if (k === 0) q.splice(1, 3, ...minus.map(x => x / s));
    else q.splice(0, 4, minus[k - 1] / s, ...[0, 1, 2].map(i => i === k - 1 ? s / 4 : plus[3 - i - (k - 1)] / s));
    return [rows[0][3], rows[1][3], rows[2][3], ...q];
  }
  /** The triangles of all shapes of a part, in the part's frame with its scale. */
  function meshOf(part) {
    const vertices = [], triangles = [], inverse = node(part).getCurrentTransform().inverse();
    const rows = rowsOf(node(part).getCurrentTransform()), scale = [0, 1, 2].map(k => lengthOf(rows, k));
    for (const shape of shapesOf(part)) {
      const local = rowsOf(inverse.mult(node(shape).getCurrentTransform())), mesh = node(shape)._cf.geometry.node._mesh;
      mesh._positions.forEach((positions, some) => {
        const first = vertices.length / 3;
        for (let v = 0; v + 2 < positions.length; v += 3)
          local.forEach((row, k) => vertices.push(scale[k] * (row[0] * positions[v] + row[1] * positions[v + 1] + row[2] * positions[v + 2] + row[3])));
        const indices = mesh._indices[some];
        if (indices?.length) for (const index of indices) triangles.push(first + index);
        else for (let v = first; v + 2 < vertices.length / 3; v += 3) triangles.push(v, v + 1, v + 2);
      });
      if (triangles.length > 3 * mostTriangles) throw tooMany();
    }
    return { vertices: Float64Array.from(vertices), triangles: Uint32Array.from(triangles) };
  }

  let all = 0;
  const parts = [];
  for (const part of outermost) {
    const mesh = meshOf(part);
    if (mesh.triangles.length === 0) continue;
    if ((all += mesh.triangles.length / 3) > mostTriangles) throw tooMany();
    engine.addMesh(mesh.vertices, mesh.triangles);
    parts.push(part);
  }
  if (parts.length < 2) throw Error('This scene has fewer than two parts with triangles.');
  engine.setBodies(parts.length);
  const poses = () => Float64Array.from(parts.flatMap(poseOf));
  const run = engine.addRun({ volume: 'sphere', strategy: 'margins', query: 'touching', kernel: 'gathered', fanOut: 2 });
  const materials = parts.map(part => [...part.querySelectorAll('material')].map(material => [material, material.getAttribute('diffuseColor')]));
  const contact = { parts, touching: [], detach() { cancelAnimationFrame(waiting); } };
  let before = null, waiting = 0;

  function paint(red) {
    materials.forEach((each, i) => {
      for (const [material, own] of each) {
        const wanted = red.has(i) ? colour : own ?? '0.8 0.8 0.8';
        if (material.getAttribute('diffuseColor') !== wanted) material.setAttribute('diffuseColor', wanted);
      }
    });
  }
  function look() {
    waiting = requestAnimationFrame(look);
    const now = poses();
    if (before && now.every((x, k) => x === before[k])) return;
    before = now;
    engine.setPoses(now);
    engine.play(run);
    const pairs = [], hits = engine.touching(run);
    let p = 0;
    for (let i = 0; i < parts.length; ++i) for (let j = i + 1; j < parts.length; ++j) if (hits[p++]) pairs.push([i, j]);
    const changed = pairs.join(';') !== contact.touching.join(';');
    contact.touching = pairs;
    paint(new Set(pairs.flat()));
    if (changed) onChange(pairs);
  }
  look();
  return contact;
}
