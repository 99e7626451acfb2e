// SPDX-License-Identifier: BSD-3-Clause
// bvlab beside three-mesh-bvh and rapier: all pairs of bodies in every frame of one motion. Each engine is a function
// of a frame's poses that gives a byte for each pair: whether the two touch.
'use strict';

const peers = (() => {
  const bodies = Array.from({ length: data.objects }, (_, i) => i);
  const self = { rows: [], done: false }, rounds = 3;
  let PEERS = null;
  const poseOf = (poses, i) => {
    const [x, y, z, w, a, b, c] = poses.subarray(7 * i, 7 * i + 7);
    return [{ x, y, z }, { w, x: a, y: b, z: c }];
  };
  /** A byte for each pair of bodies, in order. */
  function ofPairs(touch) {
    const all = new Uint8Array(data.pairCount);
    let p = 0;
    for (const i of bodies) for (let j = i + 1; j < bodies.length; ++j) all[p++] = touch(i, j);
    return all;
  }

  const bvlab = strategy => async () => {
    const engine = await engineFrom(data.engine);
    data.meshes.forEach(mesh => engine.addMesh(mesh.exact, mesh.triangles));
    engine.setBodies(data.objects);
    const run = engine.addRun({ volume: 'slab-box', strategy, query: 'touching', kernel: 'siblings', fanOut: engine.lanes });
    return poses => {
      engine.setPoses(poses);
      engine.play(run);
      return engine.touching(run);
    };
  };

  async function threeMeshBvh() {
    const geometries = data.meshes.map(mesh => {
      const geometry = new PEERS.BufferGeometry();
      geometry.setAttribute('position', new PEERS.BufferAttribute(mesh.vertices, 3));
      geometry.setIndex(new PEERS.BufferAttribute(mesh.triangles.slice(), 1));
      geometry.boundsTree = new PEERS.MeshBVH(geometry);
      return geometry;
    });
    const one = new PEERS.Vector3(1, 1, 1), place = new PEERS.Matrix4();
    const placed = bodies.map(() => new PEERS.Matrix4()), inverse = bodies.map(() => new PEERS.Matrix4());
    return poses => {
      for (const i of bodies) {
        const [at, turn] = poseOf(poses, i);
        placed[i].compose(at, new PEERS.Quaternion(turn.x, turn.y, turn.z, turn.w), one);
        inverse[i].copy(placed[i]).invert();
      }
      return ofPairs((i, j) => geometries[data.meshIndexOf(i)].boundsTree
        .intersectsGeometry(geometries[data.meshIndexOf(j)], place.multiplyMatrices(inverse[i], placed[j])));
    };
  }

  async function rapier() {
    const { RAPIER } = PEERS;
    await RAPIER.init();
    const world = new RAPIER.World({ x: 0, y: 0, z: 0 });
    const colliders = bodies.map(i => {
      const { vertices, triangles } = data.meshOf(i), body = world.createRigidBody(RAPIER.RigidBodyDesc.kinematicPositionBased());
      return world.createCollider(RAPIER.ColliderDesc.trimesh(vertices, triangles).setSensor(true)
        .setActiveCollisionTypes(RAPIER.ActiveCollisionTypes.ALL), body);
    });
    return poses => {
      for (const i of bodies) {
        const [at, turn] = poseOf(poses, i), body = colliders[i].parent();
        body.setTranslation(at, true);
        body.setRotation(turn, true);
      }
      world.step();
      return ofPairs((i, j) => world.intersectionPair(colliders[i], colliders[j]));
    };
  }

  const painted = () => new Promise(done => setTimeout(done, 20));
  /** The least time of a round, and the verdicts of the last one. */
  async function timed(name, make) {
    element('said').textContent = `${name} plays …`;
    await painted();
    let least = Infinity, verdicts = null;
    for (let round = 0; round < rounds; ++round) {
      const ask = await make(), found = [], start = performance.now();
      for (let f = 0; f < data.motionFrames; ++f) found.push(ask(data.frameOf(f)).slice());
      least = Math.min(least, (performance.now() - start) / data.motionFrames);
      verdicts = found;
      await painted();
    }
    const differ = self.rows.length === 0 ? 0
      : verdicts.reduce((sum, frame, f) => sum + frame.filter((touch, p) => touch !== self.rows[0].verdicts[f][p]).length, 0);
    const row = { name, milliseconds: least, touching: verdicts.reduce((sum, frame) => sum + frame.reduce((a, b) => a + b, 0), 0), differ, verdicts };
    self.rows.push(row);
    const cells = [name, least.toPrecision(3), (1000 * least / data.pairCount).toPrecision(3), row.touching, differ];
    element('rows').insertRow().append(...cells.map(textContent => made('td', { textContent })));
  }

  async function play() {
    document.title = element('title').textContent = `bvlab beside others · ${data.title}`;
    element('facts').textContent = `${data.objects} bodies, ${data.pairCount} pairs, ${data.motionFrames} frames.`;
    await timed('bvlab, margins', bvlab('margins'));
    await timed('bvlab, from the roots', bvlab('recursive'));
    if (data.others) {
      PEERS = new Function(`${new TextDecoder().decode(await unzipped(data.others))}; return PEERS;`)();
      await timed(`three-mesh-bvh ${data.versions['three-mesh-bvh']}`, threeMeshBvh);
      await timed(`rapier ${data.versions['@dimforge/rapier3d-compat']}`, rapier);
    }
    element('said').textContent = data.others ? ''
      : 'This page was made without three-mesh-bvh and rapier: experiments/setup gets them from npm.';
    self.done = true;
  }
  play().catch(error => problem(error.message));
  return self;
})();
