// SPDX-License-Identifier: BSD-3-Clause
// Bounding volumes as triangles and outlines. Each shape function takes a volume's numbers, in the
// order of drawn_volume.hpp, and a fineness, and appends to { corners, normals, lines }.
'use strict';

const add3 = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross3 = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit3 = a => { const l = Math.hypot(...a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
/** Two directions at right angles to a unit vector and to each other. */
function across(n) {
  const u = unit3(cross3(n, Math.abs(n[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0]));
  return [u, cross3(n, u)];
}

/** A grid of points (rows of equal length) with their normals; `closed` joins last and first column. */
function addGrid(out, rows, closed) {
  const columns = rows[0].length;
  for (let r = 0; r + 1 < rows.length; ++r)
    for (let c = 0; c < columns - (closed ? 0 : 1); ++c) {
      const d = (c + 1) % columns;
      const [p, q, s, t] = [rows[r][c], rows[r][d], rows[r + 1][d], rows[r + 1][c]];
      for (const [at, normal] of [p, t, q, q, t, s]) out.corners.push(...at), out.normals.push(...normal);
    }
}

function addLine(out, points, closed) {
  for (let i = 0; i + (closed ? 0 : 1) < points.length; ++i)
    out.lines.push(...points[i], ...points[(i + 1) % points.length]);
}

function addPolygon(out, polygon, normal) {
  for (let i = 1; i + 1 < polygon.length; ++i)
    for (const at of [polygon[0], polygon[i], polygon[i + 1]]) out.corners.push(...at), out.normals.push(...normal);
}

/** What a ball leaves that is swept over a rectangle: four quarters of it, the rectangle's size apart. */
function addSwept(out, centre, u, v, half0, half1, radius, fineness) {
  const n = cross3(u, v), columns = [];
  for (let quarter = 0; quarter < 4; ++quarter)
    for (let k = 0; k <= fineness; ++k) {
      const angle = (quarter + k / fineness) * Math.PI / 2;
      const corner = add3(add3(centre, u, quarter % 3 ? -half0 : half0), v, quarter < 2 ? half1 : -half1);
      columns.push([corner, add3(u.map(x => x * Math.cos(angle)), v, Math.sin(angle))]);
    }
  const rows = [];
  for (let r = 0; r <= 2 * fineness; ++r) {
    const polar = r * Math.PI / (2 * fineness);
    rows.push(columns.map(([corner, out]) => {
      const normal = add3(out.map(x => x * Math.sin(polar)), n, Math.cos(polar));
      return [add3(corner, normal, radius), normal];
    }));
  }
  addGrid(out, rows, true);
  const corner = row => [0, 1, 2, 3].map(q => row[q * (fineness + 1)][0]);
  if (half0 * half1 > 0) {
    addPolygon(out, corner(rows[0]), n);
    addPolygon(out, corner(rows[2 * fineness]), n.map(x => -x));
  }
  addLine(out, rows[fineness].map(([at]) => at), true);
  for (const q of [0, 1, 2, 3])
    for (const c of half0 + half1 > 0 ? [q * (fineness + 1), q * (fineness + 1) + fineness] : [q * (fineness + 1)])
      addLine(out, rows.map(row => row[c][0]), false);
}

function addShell(out, centre, axis, inner, outer, cosine, fineness) {
  const n = unit3(axis), [u, v] = across(n);
  if (!(cosine > 0)) {
    for (const radius of inner > 0 ? [outer, inner] : [outer]) addSwept(out, centre, u, v, 0, 0, radius, fineness);
    return;
  }
  const widest = Math.acos(Math.min(1, cosine)), around = 4 * fineness, rings = Math.max(2, fineness);
  const direction = (polar, k) => {
    const angle = 2 * Math.PI * k / around;
    return add3(add3(n.map(x => x * Math.cos(polar)), u, Math.sin(polar) * Math.cos(angle)), v,
                Math.sin(polar) * Math.sin(angle));
  };
  const ring = (polar, radius, sign) => Array.from({ length: around }, (_, k) => {
    const way = direction(polar, k);
    return [add3(centre, way, radius), way.map(x => sign * x)];
  });
  for (const [radius, sign] of [[outer, 1], [inner, -1]]) {
    addGrid(out, Array.from({ length: rings + 1 }, (_, r) => ring(widest * r / rings, radius, sign)), true);
    addLine(out, ring(widest, radius, 1).map(([at]) => at), true);
    for (const k of [0, fineness, 2 * fineness, 3 * fineness])
      addLine(out, Array.from({ length: rings + 1 }, (_, r) => add3(centre, direction(widest * r / rings, k), radius)), false);
  }
  const side = radius => ring(widest, radius, 1).map(([at, way]) => [at, unit3(add3(way, n, -1 / cosine))]);
  addGrid(out, [side(outer), side(inner)], true);
  for (const k of [0, fineness, 2 * fineness, 3 * fineness]) {
    const way = direction(widest, k);
    addLine(out, [add3(centre, way, inner), add3(centre, way, outer)], false);
  }
}

/** The polygons of what lies on the inner side of all planes: each cut out of its plane by the others. */
function addHalfSpaces(out, normals, bounds) {
  const large = 4 * bounds.reduce((most, b) => Math.max(most, Math.abs(b)), 1e-30), tiny = 1e-7 * large;
  normals.forEach((normal, m) => {
    const length = Math.hypot(...normal), n = normal.map(x => x / length), [u, v] = across(n);
    const middle = n.map(x => x * bounds[m] / length);
    let polygon = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => add3(add3(middle, u, a * large), v, b * large));
    for (let k = 0; k < normals.length && polygon.length > 0; ++k)
      if (k !== m) polygon = cut(polygon, normals[k], bounds[k] + tiny);
    if (polygon.length < 3) return;
    addPolygon(out, polygon, n);
    addLine(out, polygon, true);
  });
}

function cut(polygon, normal, bound) {
  const kept = [];
  let before = polygon[polygon.length - 1], above = dot3(normal, before) - bound;
  for (const here of polygon) {
    const now = dot3(normal, here) - bound;
    if ((above > 0) !== (now > 0)) {
      const t = above / (above - now);
      kept.push(before.map((x, i) => x + t * (here[i] - x)));
    }
    if (now <= 0) kept.push(here);
    before = here, above = now;
  }
  return kept;
}

// K-DOPs are compared in the world: bounded again there by their own directions, three old bounds
// for each new one (see kdop_realigned.hpp).
const cubeDirections = [
  [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1],
  [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]];
const slabsOf = k => cubeDirections.slice(0, k === 18 ? 3 : k / 2).concat(k === 18 ? cubeDirections.slice(7) : []);
const normalsOf = k => slabsOf(k).flatMap(d => [d, d.map(x => -x)]);

/** For each direction of a K-DOP that is turned by a rotation (its rows): weights and the bounds to sum. */
function realignment(k, rows) {
  const normals = normalsOf(k);
  const index = d => normals.findIndex(n => n.every((x, i) => x === d[i]));
  return normals.map(d => {
    const n = [0, 1, 2].map(i => rows[0][i] * d[0] + rows[1][i] * d[1] + rows[2][i] * d[2]);
    const order = [0, 1, 2].sort((a, b) => Math.abs(n[b]) - Math.abs(n[a]));
    const [x, y, z] = order.map(i => Math.abs(n[i]));
    const from = (...parts) => {
      const way = [0, 0, 0];
      order.forEach((i, at) => { way[i] = parts[at] && n[i] < 0 ? -parts[at] : parts[at]; });
      return index(way);
    };
    return k === 6 ? [[x, from(1, 0, 0)], [y, from(0, 1, 0)], [z, from(0, 0, 1)]]
      : k === 14 ? [[x - y, from(1, 0, 0)], [(y + z) / 2, from(1, 1, 1)], [(y - z) / 2, from(1, 1, -1)]]
      : k === 26 ? [[x - y, from(1, 0, 0)], [y - z, from(1, 1, 0)], [z, from(1, 1, 1)]]
      : x >= y + z ? [[x - y - z, from(1, 0, 0)], [y, from(1, 1, 0)], [z, from(1, 0, 1)]]
      : [[(x + y - z) / 2, from(1, 1, 0)], [(x + z - y) / 2, from(1, 0, 1)], [Math.max(0, (y + z - x) / 2), from(0, 1, 1)]];
  });
}

const volumes = (() => {
  const kind = () => data.drawn_as, isKdop = () => kind() === 'k-dop';
  const shapes = {
    'ball': (v, out, fineness) => addSwept(out, v.slice(0, 3), [1, 0, 0], [0, 1, 0], 0, 0, v[3], fineness),
    'rectangle': (v, out, fineness) =>
      addSwept(out, v.slice(0, 3), v.slice(3, 6), v.slice(6, 9), v[9], v[10], v[11], fineness),
    'shell': (v, out, fineness) => addShell(out, v.slice(0, 3), v.slice(3, 6), v[6], v[7], v[8], fineness),
    'slab-box': (v, out) => {
      const at = v.slice(0, 3), slab = v.slice(6, 9), middle = dot3(slab, at) + v[9];
      const ways = [[1, 0, 0], [0, 1, 0], [0, 0, 1]], sides = ways.flatMap(way => [way, way.map(x => -x)]);
      const bounds = [0, 1, 2].flatMap(k => [v[3 + k] + at[k], v[3 + k] - at[k]]);
      addHalfSpaces(out, [...sides, slab, slab.map(x => -x)], [...bounds, v[10] + middle, v[10] - middle]);
    },
    'box': (v, out) => {
      const at = v.slice(0, 3), axes = [v.slice(3, 6), v.slice(6, 9), v.slice(9, 12)], half = v.slice(12, 15);
      for (let i = 0; i < 3; ++i)
        for (const sign of [1, -1]) {
          const [j, k] = [(i + 1) % 3, (i + 2) % 3];
          const polygon = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) =>
            add3(add3(add3(at, axes[i], sign * half[i]), axes[j], a * half[j]), axes[k], b * half[k]));
          addPolygon(out, polygon, axes[i].map(x => sign * x));
          if (i < 2) addLine(out, polygon, true);
        }
    },
  };

  const nothing = () => ({ corners: [], normals: [], lines: [] });
  const known = new Map();  // of what turns with its body: shapes, by mesh, node and fineness
  function shapeOf(m, node, fineness) {
    const key = (node * 64 + fineness) * data.meshes.length + m;
    if (!known.has(key)) {
      const { numbers, volumes } = data.meshes[m], out = nothing();
      shapes[kind()](Array.from(volumes.subarray(node * numbers, (node + 1) * numbers)), out, fineness);
      if (known.size > 4000) known.clear();
      known.set(key, joined([out]));
    }
    return known.get(key);
  }
  /** One shape of several, as arrays to draw. */
  function joined(parts) {
    const whole = nothing();
    for (const name in whole) {
      whole[name] = new Float32Array(parts.reduce((sum, part) => sum + part[name].length, 0));
      let at = 0;
      for (const part of parts) whole[name].set(part[name], at), at += part[name].length;
    }
    return whole;
  }

  return {
    get drawable() { return isKdop() || kind() in shapes; },
    /** Whether it stays along the world's axes, and so changes its shape when its body turns. */
    get realigned() { return isKdop(); },
    get most() { return isKdop() ? 256 : 1024; },
    /** After other volumes have come into the data. */
    forget() { known.clear(); },
    /** In the body's own frame; of k-DOPs along the world's axes, when the body is turned by these rows. */
    shape(m, nodes, rows) {
      if (isKdop()) {
        const { numbers, volumes } = data.meshes[m], normals = normalsOf(numbers);
        const along = realignment(numbers, rows), out = nothing();
        for (const node of nodes) {
          const old = volumes.subarray(node * numbers, (node + 1) * numbers);
          addHalfSpaces(out, normals, along.map(terms => terms.reduce((sum, [weight, from]) => sum + weight * old[from], 0)));
        }
        return joined([out]);
      }
      const fineness = nodes.length <= 16 ? 10 : nodes.length <= 128 ? 6 : 4;
      return joined(nodes.map(node => shapeOf(m, node, fineness)));
    },
    /** The nodes that many levels below the root, and leaves above them. */
    level(m, level) {
      const { children, depths } = data.meshes[m], nodes = [];
      children.forEach((first, node) => {
        if (depths[node] === level || (depths[node] < level && first === 0)) nodes.push(node);
      });
      return nodes;
    },
  };
})();

/** What of the pair's volumes is chosen: a level of the trees, the front, or none. */
const which = () => document.querySelector('input[name="which"]:checked').value;
function onWhich(act) {
  for (const radio of document.querySelectorAll('input[name="which"]')) radio.addEventListener('change', act);
  element('level').addEventListener('input', act);
}
function showLevel() {
  element('level').disabled = which() !== 'level';
  element('level-number').textContent = element('level').value;
}
