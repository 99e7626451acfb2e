// SPDX-License-Identifier: BSD-3-Clause
// The bodies and the volumes of a pair, drawn. Nothing is drawn that has not changed.
'use strict';

const scene = (() => {
  const canvas = element('scene');
  // Three.js writes an error to the console where it finds no WebGL: a canvas of its own shows beforehand whether there is any.
  const webgl = document.createElement('canvas').getContext('webgl2') !== null;
  if (!webgl || typeof THREE === 'undefined') {
    canvas.replaceWith(made('p', { id: 'no-webgl', textContent: (webgl
      ? 'This page was made without three.js, which draws: experiments/setup gets it from npm. The scene is not drawn. '
      : 'This browser shows no 3D here (WebGL 2 is off or missing): the scene is not drawn. ')
      + 'Curves, pairs and numbers are all there; --x3d writes the scene for other viewers.' }));
    return new Proxy({}, { get: () => () => {} });
  }
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  const world = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
  camera.up.set(0, 0, 1);
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.position.set(-1, -2, 3);
  camera.add(new THREE.DirectionalLight(0xffffff, 0.7));
  world.add(camera, sun, new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.3));
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.addEventListener('change', () => { changed = true; });

  const geometries = data.meshes.map(mesh => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(mesh.vertices, 3));
    geometry.setIndex(new THREE.BufferAttribute(mesh.triangles, 1));
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
    return geometry;
  });
  const names = ['body', 'touching', 'first', 'second', 'lit'];
  const materials = {};
  // Many that one can look through hide what is behind them.
  const faint = Math.max(0.04, Math.min(0.13, 1.3 / data.objects));
  for (const name of names)
    for (const faded of [false, true])
      materials[name + faded] = new THREE.MeshLambertMaterial({
        side: THREE.DoubleSide, flatShading: true, transparent: faded, opacity: faded ? faint : 1, depthWrite: !faded });
  const bodies = Array.from({ length: data.objects }, (_, i) => {
    const body = new THREE.Mesh(geometries[data.meshIndexOf(i)], materials.bodyfalse);
    body.userData.index = i;
    world.add(body);
    return body;
  });

  // Of the first body and of the second, and again of what is lit: faces one can look through, and outlines.
  const shown = ['first', 'second', 'lit', 'lit'].map(name => {
    const face = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide, transparent: true, opacity: name === 'lit' ? 0.3 : 0.16, depthWrite: false });
    const line = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75, depthWrite: false });
    const group = new THREE.Group();
    group.add(new THREE.Mesh(new THREE.BufferGeometry(), face), new THREE.LineSegments(new THREE.BufferGeometry(), line));
    for (const child of group.children) child.frustumCulled = false, child.renderOrder = 1;
    group.visible = false;
    world.add(group);
    return { name, group, face, line, opacity: face.opacity };
  });

  // Segments between points in the world, over everything else: rods, since WebGL draws lines one pixel wide.
  // Transparent, though solid, since what is transparent is drawn after the rest.
  const lines = ['contact', 'nearest'].map(name => {
    const material = new THREE.MeshLambertMaterial({ color: 0, transparent: true, depthTest: false, side: THREE.DoubleSide });
    const drawn = new THREE.Mesh(new THREE.BufferGeometry(), material);
    drawn.frustumCulled = false, drawn.renderOrder = 3;
    world.add(drawn);
    return { name, drawn, material };
  });
  /** Six numbers a segment. */
  function showLines(name, corners) {
    const { drawn } = lines.find(each => each.name === name);
    if (drawn.geometry.attributes.position?.count > 0 || corners.length > 0) changed = true;
    const thick = Math.max(...geometries.map(geometry => geometry.boundingSphere.radius)) / 90, sides = [];
    for (let k = 0; k + 5 < corners.length; k += 6) {
      const from = corners.slice(k, k + 3), to = corners.slice(k + 3, k + 6), [u, v] = across(unit3(add3(to, from, -1)));
      const edges = [0, 1, 2].map(e => 2 * Math.PI * e / 3).map(angle =>
        [from, to].map(end => add3(add3(end, u, thick * Math.cos(angle)), v, thick * Math.sin(angle))));
      edges.forEach(([a, b], e) => {
        const [c, d] = edges[(e + 1) % 3];
        sides.push(...a, ...c, ...b, ...b, ...c, ...d);
      });
    }
    drawn.geometry.dispose();
    drawn.geometry = new THREE.BufferGeometry();
    drawn.geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(sides), 3));
    drawn.geometry.computeVertexNormals();
  }

  function colours() {
    for (const { name, material } of lines) material.emissive.set(look.colour(name));
    for (const name of names)
      for (const faded of [false, true]) materials[name + faded].color.set(look.colour(name));
    for (const { name, face, line } of shown) face.color.set(look.colour(name)), line.color.set(look.colour(name));
    changed = true;
  }

  let changed = true, frame = 0;
  const stride = data.objects * 7;
  const put = f => {
    frame = f;
    if (data.frames === 0) return;
    bodies.forEach((body, i) => {
      const at = f * stride + i * 7, v = data.poses;
      body.position.set(v[at], v[at + 1], v[at + 2]);
      body.quaternion.set(v[at + 4], v[at + 5], v[at + 6], v[at + 3]).normalize();
    });
    changed = true;
  };

  /** Bodies of `touching` pairs stand out, and all that are not of the chosen pair fade. */
  function paint(touching, pair) {
    const hit = new Uint8Array(data.objects);
    for (const p of touching) for (const i of data.pairOf(p)) hit[i] = 1;
    bodies.forEach((body, i) => {
      const own = pair ? pair.indexOf(i) : -1, faded = pair !== null && own < 0;
      body.material = materials[(hit[i] ? 'touching' : own >= 0 ? names[2 + own] : 'body') + faded];
      body.renderOrder = faded ? 2 : 0;
    });
    changed = true;
  }

  const rowsOf = body => {
    const e = new THREE.Matrix4().makeRotationFromQuaternion(body.quaternion).elements;
    return [0, 1, 2].map(r => [e[r], e[4 + r], e[8 + r]]);
  };

  /** Draws these nodes' volumes of the pair's two bodies (or nothing); nodes of both that are lit come after. */
  function showVolumes(pair, nodes) {
    shown.forEach(({ group, face, line, opacity }, side) => {
      group.visible = pair !== null && (nodes[side]?.length ?? 0) > 0;
      if (!group.visible) return;
      // Bodies and contacts are to be seen through them; what is lit, over the rest.
      const many = nodes[side].length;
      face.opacity = opacity * Math.min(1, 8 / many), line.opacity = 0.75 * Math.max(side < 2 ? 0.06 : 0.2, Math.min(1, 20 / many));
      const i = pair[side % 2], body = bodies[i];
      const { corners, normals, lines } = volumes.shape(data.meshIndexOf(i), nodes[side], volumes.realigned ? rowsOf(body) : null);
      const [faces, outline] = group.children;
      for (const child of group.children) child.geometry.dispose(), child.geometry = new THREE.BufferGeometry();
      faces.geometry.setAttribute('position', new THREE.BufferAttribute(corners, 3));
      faces.geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
      outline.geometry.setAttribute('position', new THREE.BufferAttribute(lines, 3));
    });
    placeVolumes(pair);
  }
  /** After the bodies have moved: volumes that keep their shape go with them. */
  function placeVolumes(pair) {
    if (pair) shown.forEach(({ group }, side) => {
      group.position.copy(bodies[pair[side % 2]].position);
      if (volumes.realigned) group.quaternion.identity();
      else group.quaternion.copy(bodies[pair[side % 2]].quaternion);
    });
    changed = true;
  }

  /** A ball around bodies where they stand, or over the whole trace where none are named. */
  function ballAround(some) {
    const low = new THREE.Vector3(Infinity, Infinity, Infinity), high = low.clone().negate(), at = new THREE.Vector3();
    const { poses: v, frames } = some ? data : data.viewed ?? data, step = some ? 1 : Math.max(1, Math.floor(frames / 64));
    for (let f = some ? frame : 0; f < (some ? frame + 1 : frames); f += step)
      for (const i of some ?? bodies.keys()) {
        const { center, radius } = bodies[i].geometry.boundingSphere, k = f * stride + i * 7;
        at.copy(center).applyQuaternion(new THREE.Quaternion(v[k + 4], v[k + 5], v[k + 6], v[k + 3]).normalize());
        at.x += v[k], at.y += v[k + 1], at.z += v[k + 2];
        low.min(at.clone().addScalar(-radius)), high.max(at.clone().addScalar(radius));
      }
    if (!(low.x <= high.x)) return { centre: new THREE.Vector3(), radius: 1, tall: 0 };
    const all = high.clone().sub(low).length() / 2, tall = (high.z - low.z) / 2;
    return { centre: low.add(high).multiplyScalar(0.5), radius: all || 1, tall };
  }
  function lookAt(some) {
    const { centre, radius, tall } = ballAround(some);
    const narrow = Math.min(1, camera.aspect), way = some ? camera.position.clone().sub(controls.target).normalize() : new THREE.Vector3(0.55, -0.75, 0.4).normalize();
    controls.target.copy(centre);
    const distance = (some ? 0.92 * radius : Math.max(0.75 * radius, 1.05 * tall)) / Math.sin(camera.fov * Math.PI / 360) / narrow;
    camera.position.copy(centre).addScaledVector(way, distance);
    camera.near = distance / 500, camera.far = distance * 50;
    camera.updateProjectionMatrix();
    controls.update();
    changed = true;
  }

  function fit() {
    const { width, height } = canvas.getBoundingClientRect();
    if (width === 0 || height === 0) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    changed = true;
  }
  new ResizeObserver(fit).observe(canvas);

  /** Where a pointer is in the canvas, -1 to 1 each way. */
  function pointOf(event) {
    const box = canvas.getBoundingClientRect();
    return new THREE.Vector2((event.clientX - box.left) / box.width * 2 - 1, 1 - (event.clientY - box.top) / box.height * 2);
  }
  function pointedAt(event) {
    const ray = new THREE.Raycaster();
    ray.setFromCamera(pointOf(event), camera);
    return ray.intersectObjects(bodies, false)[0] ?? null;
  }

  /** Where in the canvas a body can be taken hold of, in pixels; null where others hide it. */
  function placeOf(i) {
    const { array } = bodies[i].geometry.attributes.position, index = bodies[i].geometry.index.array, ray = new THREE.Raycaster();
    for (const each of [camera, ...bodies]) each.updateMatrixWorld();
    for (let t = 0; t + 2 < index.length; t += 3) {
      const middle = [0, 1, 2].map(k => (array[3 * index[t] + k] + array[3 * index[t + 1] + k] + array[3 * index[t + 2] + k]) / 3);
      const at = new THREE.Vector3(...middle).applyMatrix4(bodies[i].matrixWorld).project(camera);
      ray.setFromCamera(new THREE.Vector2(at.x, at.y), camera);
      if (ray.intersectObjects(bodies, false)[0]?.object === bodies[i])
        return { x: (at.x + 1) / 2 * canvas.clientWidth, y: (1 - at.y) / 2 * canvas.clientHeight };
    }
    return null;
  }

  /** Calls back with the number of a body that was clicked, not dragged; null for none. */
  function onClick(act) {
    let down = null;
    canvas.addEventListener('pointerdown', event => { down = [event.clientX, event.clientY]; }, true);
    canvas.addEventListener('pointerup', event => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      act(pointedAt(event)?.object.userData.index ?? null);
    });
  }

  /** What is dragged is a body, where one is under the pointer: `begin(body)`, `move(way, turn)` with the way of the
   *  pointer in the world and in pixels, `end()`. Else the camera goes round. */
  function onDrag({ begin, move, end }) {
    let held = null;
    canvas.addEventListener('pointerdown', event => {
      const hit = held ? null : pointedAt(event);
      if (!hit) return;
      event.stopImmediatePropagation();  // the camera stays
      canvas.setPointerCapture(event.pointerId);
      const depth = hit.point.clone().project(camera).z;
      held = { id: event.pointerId, depth, at: hit.point, x: event.clientX, y: event.clientY };
      begin(hit.object.userData.index);
    }, true);
    canvas.addEventListener('pointermove', event => {
      if (event.pointerId !== held?.id) return;
      const { x, y } = pointOf(event), at = new THREE.Vector3(x, y, held.depth).unproject(camera);
      move(at.clone().sub(held.at).toArray(), [event.clientX - held.x, event.clientY - held.y], event);
      Object.assign(held, { at, x: event.clientX, y: event.clientY });
    });
    for (const name of ['pointerup', 'pointercancel'])
      canvas.addEventListener(name, event => {
        if (event.pointerId !== held?.id) return;
        held = null;
        end();
      });
  }
  /** The camera's right, up and back, in the world. */
  function directions() {
    const ways = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    camera.matrixWorld.extractBasis(...ways);
    return ways.map(way => way.toArray());
  }

  function draw() {
    if (!changed) return;
    changed = false;
    renderer.render(world, camera);
  }

  look.onChange(colours);
  colours();
  put(0);
  fit();
  lookAt(null);
  return { put, paint, showVolumes, placeVolumes, showLines, lookAt, onClick, onDrag, placeOf, directions, draw };
})();
