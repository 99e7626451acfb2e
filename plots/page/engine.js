// SPDX-License-Identifier: BSD-3-Clause
// The engine of experiments/live in this page: a WebAssembly module and what its functions mean.
// `engineFrom({ engine, relaxed })` takes the module, gzipped and in base64, and one for lanes that multiply and add with
// one rounding, if there is one; it promises the engine. A refusal is an Error whose message is a sentence to show.
'use strict';

/** Bytes of base64, unzipped. */
async function unzipped(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

/** Whether relaxed SIMD is there and rounds a product and a sum once: it may, where the processor does. */
async function roundsOnce() {
  // (func (export "f") (param f32 f32 f32) (result f32)): f32x4.relaxed_madd of their splats, and of that a lane
  const module = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 8, 1, 96, 3, 125, 125, 125, 1, 125, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0,
    10, 22, 1, 20, 0, 32, 0, 253, 19, 32, 1, 253, 19, 32, 2, 253, 19, 253, 133, 2, 253, 31, 0, 11);
  if (!WebAssembly.validate(module)) return false;
  const { instance } = await WebAssembly.instantiate(module);
  // The square is 1 + 2^-11 + 2^-24, of which the last term is lost where it is rounded by itself.
  return instance.exports.f(1 + 2 ** -12, 1 + 2 ** -12, -1 - 2 ** -11) === 2 ** -24;
}

async function engineFrom({ engine, relaxed }) {
  if (typeof WebAssembly !== 'object') throw Error('This browser has no WebAssembly: the engine does not run here.');
  // (func (result v128) (i32.const 0) (i8x16.splat))
  const simd = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 8, 1, 6, 0, 65, 0, 253, 15, 11);
  if (!WebAssembly.validate(simd)) throw Error('The WebAssembly of this browser has no SIMD, which the engine is compiled for.');
  if (typeof DecompressionStream !== 'function') throw Error('This browser cannot unzip (DecompressionStream): the engine does not run here.');
  let memory = null;
  const bytesAt = (at, size) => new Uint8Array(memory.buffer, at, size);
  const textAt = at => {
    const all = new Uint8Array(memory.buffer);
    return new TextDecoder().decode(all.subarray(at, all.indexOf(0, at)));
  };
  // What the module asks of a system that it does not have here: 8 is "no such file".
  const nothing = new Proxy({}, { get: () => () => 8 });
  const bytes = await unzipped(relaxed && await roundsOnce() ? relaxed : engine).catch(() => { throw Error('The engine in this page is damaged.'); });
  const { instance } = await WebAssembly.instantiate(bytes, {
    wasi_snapshot_preview1: nothing,
    bvlab: { fail: at => { throw Error(textAt(at)); } },
  });
  const f = instance.exports;
  memory = f.memory;
  f._initialize();

  const put = values => {
    const at = f.room(Math.max(1, values.byteLength));
    if (at === 0) throw Error('There is not enough memory in this browser for these meshes.');
    bytesAt(at, values.byteLength).set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength));
    return at;
  };
  /** An array in the module's memory: a view, until the next call. */
  const view = (Type, at) => {
    const [begin, size] = new Uint32Array(memory.buffer, at, 2);
    return new Type(memory.buffer, size ? begin : 0, size);
  };
  let bodies = 0;

  return {
    lanes: f.lanes(),
    /** Vertices: Float64Array of x y z; triangles: Uint32Array of three each. Before `setBodies`. */
    addMesh(vertices, triangles) {
      f.add_mesh(put(vertices), vertices.length / 3, put(triangles), triangles.length / 3);
    },
    /** Body i has mesh i modulo the number of meshes. */
    setBodies(count) { f.set_bodies(bodies = count); },
    /** x y z qw qx qy qz of each body, for the next frame of every run. */
    setPoses(poses) { new Float64Array(memory.buffer, f.next_poses(), 7 * bodies).set(poses); },
    /** A number, or null where the engine has not these together. */
    addRun({ volume, strategy, query, kernel, fanOut }) {
      const words = new TextEncoder().encode([volume, strategy, query, kernel, ''].join('\0'));
      const run = f.add_run(put(words), fanOut);
      return run < 0 ? null : run;
    },
    endRun: run => f.end_run(run),
    play: run => f.play(run),
    /** Of the frame played last: N_u, N_v, N_p, entries of all fronts, hits, N_b. */
    counts: run => view(Float64Array, f.counts(run)),
    touching: run => view(Uint8Array, f.touching(run)),
    distances: run => view(Float64Array, f.distances(run)),
    /** Frame (of no use), body, body, triangle, triangle; of each contact, sorted. */
    contacts: run => view(Uint32Array, f.contacts(run)),
    /** Has `front` tell of that pair; of none where it is -1. */
    watch: (run, pair) => f.watch(run, pair),
    /** Of each entry its two nodes, and 1 where the frame tested it. */
    front: run => view(Uint32Array, f.front(run)),
    /** The nearest points of two bodies, as the poses were put last: x y z, x y z. */
    nearest: (i, j) => view(Float64Array, f.nearest(i, j)),
    /** Of each node the first of its children and their number. */
    children: (run, mesh) => view(Uint32Array, f.children(run, mesh)),
    volumes: (run, mesh) => view(Float32Array, f.volumes(run, mesh)),
    drawnAs: run => new TextDecoder().decode(view(Uint8Array, f.drawn_as(run)).slice()),
  };
}
