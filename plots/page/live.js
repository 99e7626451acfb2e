// SPDX-License-Identifier: BSD-3-Clause
// The live page: the engine plays what the motion does, or the hand. `live` is for tests and the console.
'use strict';

const live = (() => {
  const colours = ['accent', 'run-1', 'run-2', 'run-3', 'run-4'];
  const whole = new Intl.NumberFormat('en');
  const state = { frame: 0, playing: false, free: false, pair: null, waiting: null, held: null };
  const poses = new Float64Array(7 * data.objects), middle = Array.from(data.frameOf(0).subarray(0, 3));
  const self = { state, poses, runs: [], recorded: null, engine: null };
  const runs = self.runs;
  const speeds = Array.from({ length: data.objects }, () => ({ way: [0, 0, 0], turn: [0, 0, 0] }));
  let offered = {}, touching = [];

  // Bodies: quaternions are w x y z, as in a trace.
  const times = ([a, b, c, d], [e, f, g, h]) =>
    [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
  const turnOf = v => {
    const angle = Math.hypot(...v), s = angle > 0 ? Math.sin(angle / 2) / angle : 0;
    return [Math.cos(angle / 2), v[0] * s, v[1] * s, v[2] * s];
  };
  const dot4 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const rotated = (v, q) => times(times(q, [0, ...v]), [q[0], -q[1], -q[2], -q[3]]).slice(1).map(x => x / dot4(q, q));
  const poseOf = i => poses.subarray(7 * i, 7 * i + 7);
  const boxes = data.meshes.map(({ exact }) => {
    const low = Array(3).fill(Infinity), high = Array(3).fill(-Infinity);
    exact.forEach((x, k) => { low[k % 3] = Math.min(low[k % 3], x), high[k % 3] = Math.max(high[k % 3], x); });
    return { centre: low.map((x, k) => (x + high[k]) / 2), radius: Math.hypot(...low.map((x, k) => high[k] - x)) / 2 };
  });
  const boxOf = i => boxes[data.meshIndexOf(i)];
  const largest = Math.max(...boxes.map(box => box.radius));
  const centreOf = i => add3(Array.from(poseOf(i).subarray(0, 3)), rotated(boxOf(i).centre, poseOf(i).subarray(3)));
  /** Moves a body by a way, and turns it about its middle. */
  function moveBody(i, way, turn = [0, 0, 0]) {
    const pose = poseOf(i), centre = add3(centreOf(i), way);
    if (turn.some(x => x !== 0)) {
      const q = times(turnOf(turn), Array.from(pose.subarray(3))), length = Math.sqrt(dot4(q, q));
      pose.set(q.map(x => x / length), 3);
    }
    pose.set(add3(centre, rotated(boxOf(i).centre, pose.subarray(3)), -1), 0);
  }
  self.moveBody = (i, way, turn) => { byHand(), moveBody(i, way, turn), playNow(); };

  // Runs; of one of them volumes, answers and the front are drawn.
  const drawn = () => runs.find(run => run.isDrawn) ?? runs[0];
  function start(run) {
    if (run.number !== null) self.engine.endRun(run.number);
    run.number = self.engine.addRun({ ...run, query: element('query').value });
    run.past = [], run.times = [], run.rebuilt = null, run.length = 0;
    run.said.textContent = run.number === null ? `not with ${element('query').value}` : '';
  }
  function restart() {
    runs.forEach(start);
    takeTrees();
    watch();
  }
  /** What the trees of the run that is drawn look like. */
  function takeTrees() {
    const run = drawn();
    volumes.forget();
    data.drawn_as = run.number === null ? '' : self.engine.drawnAs(run.number);
    data.meshes.forEach((mesh, m) => {
      if (run.number === null) return;
      const children = self.engine.children(run.number, m).slice(), nodes = children.length / 2;
      mesh.volumes = self.engine.volumes(run.number, m).slice();
      mesh.numbers = mesh.volumes.length / nodes;
      mesh.children = new Uint32Array(nodes), mesh.depths = new Uint16Array(nodes);
      for (let node = 0; node < nodes; ++node) {
        const [from, count] = children.subarray(2 * node, 2 * node + 2);
        if (count === 0) continue;
        mesh.children[node] = from;
        mesh.depths.fill(mesh.depths[node] + 1, from, from + count);
      }
      mesh.deepest = mesh.depths.reduce((a, b) => Math.max(a, b), 0);
    });
    element('level').max = Math.max(...data.meshes.map(mesh => mesh.deepest));
  }
  const watch = () => {
    if (drawn().number !== null) self.engine.watch(drawn().number, state.pair ? data.numberOf(...state.pair) : -1);
  };

  /** The mean of the middle half, since a browser's clock is coarse; of few times the least. */
  function usual(times) {
    const sorted = [...times].sort((a, b) => a - b), middle = sorted.slice(times.length >> 2, Math.ceil(0.75 * times.length));
    return times.length < 8 ? sorted[0] : middle.reduce((a, b) => a + b) / middle.length;
  }
  /** Plays the poses as they are: the next frame of all runs. */
  function advance() {
    self.engine.setPoses(poses);
    self.recorded?.push(Array.from(poses));
    for (const run of runs) {
      if (run.number === null) continue;
      const before = performance.now();
      self.engine.play(run.number);
      run.times.push(performance.now() - before);
      if (run.times.length > 30) run.times.shift();
      const [nu, nv, np, front, hits, nb] = self.engine.counts(run.number);
      run.counts = { nu, nv, np, nb, hits };
      if (run === drawn()) noteRebuilding(run);
      curves.add(run, [nu, nv, np, front, hits, nb, usual(run.times)]);
    }
  }
  /** A list that is never raised grows until it is built anew from the roots. */
  function noteRebuilding(run) {
    const { length } = self.engine.front(run.number);
    if (length < run.length && ['separation-list', 'deferred'].includes(run.strategy)) run.rebuilt = 0;
    else if (run.rebuilt !== null) ++run.rebuilt;
    run.length = length;
  }
  const playNow = () => { advance(), draw(); };
  /** To a frame of the motion. What a front holds depends on all frames before, so these are played, too. */
  function seek(frame) {
    frame = Math.min(Math.max(0, frame), data.motionFrames - 1);
    let next = state.frame + 1;
    if (state.free || frame < next) restart(), next = 0;
    state.free = false;
    for (; next <= frame; ++next) poses.set(data.frameOf(next)), advance();
    state.frame = frame;
    draw();
  }
  self.seek = frame => { play(false), seek(frame); };

  // What is seen
  function answer() {
    const run = drawn(), pairs = new Set();
    if (run.number === null) return pairs;
    const query = element('query').value;
    if (query === 'touching') self.engine.touching(run.number).forEach((hit, p) => { if (hit) pairs.add(p); });
    if (query === 'distance') self.engine.distances(run.number).forEach((d, p) => { if (d === 0) pairs.add(p); });
    if (query === 'contacts') {
      const contacts = self.engine.contacts(run.number);
      for (let k = 0; k < contacts.length; k += 5) pairs.add(data.numberOf(contacts[k + 1], contacts[k + 2]));
    }
    return pairs;
  }
  self.touching = () => [...answer()].sort((a, b) => a - b);
  const seen = points => points.map((x, k) => x - middle[k % 3]);

  function showLines() {
    const run = drawn(), query = element('query').value, corners = [];
    if (query === 'contacts' && run.number !== null) {
      const contacts = self.engine.contacts(run.number).slice(0, 5 * 4000);
      for (let k = 0; k < contacts.length; k += 5) {
        const [, i, j, a, b] = contacts.subarray(k, k + 5);
        const segment = segmentOf(posedTriangle(data.meshOf(i), a, poseOf(i)), posedTriangle(data.meshOf(j), b, poseOf(j)));
        if (segment) corners.push(...seen(segment.flat()));
      }
    }
    scene.showLines('contact', corners);
    const apart = query === 'distance' && state.pair && !touching.has(data.numberOf(...state.pair));
    scene.showLines('nearest', apart ? seen(Array.from(self.engine.nearest(...state.pair))) : []);
  }

  function nodesNow() {
    if (which() === 'level') {
      const level = Number(element('level').value), nodes = state.pair.map(i => volumes.level(data.meshIndexOf(i), level));
      return [nodes, `level ${level}: ${nodes[0].length} + ${nodes[1].length} volumes`];
    }
    const entries = self.engine.front(drawn().number), rest = [new Set(), new Set()], lit = [new Set(), new Set()];
    let tested = 0;
    for (let k = 0; k < entries.length; k += 3) {
      tested += entries[k + 2];
      for (const side of [0, 1]) (entries[k + 2] ? lit : rest)[side].add(entries[k + side]);
    }
    for (const side of [0, 1]) for (const node of lit[side]) rest[side].delete(node);
    const words = entries.length ? `${whole.format(entries.length / 3)} entries, ${whole.format(tested)} of them tested in this frame (lit). `
        + (drawn().rebuilt === null ? '' : `The list was rebuilt from the roots ${drawn().rebuilt ? `${drawn().rebuilt} frames ago` : 'in this frame'}.`)
      : drawn().kernel !== 'gathered' ? 'An entry of this front is a step of many lanes: it is counted, not drawn.'
      : drawn().strategy === 'recursive' ? 'recursive starts from the roots: it keeps no front.' : 'No front is kept in this frame.';
    return [[...rest, ...lit].map(nodes => [...nodes]), words];
  }
  function showVolumes() {
    showLevel();
    const some = state.pair !== null && which() !== 'none' && drawn().number !== null;
    const [nodes, words] = some ? nodesNow() : [[], ''];
    scene.showVolumes(some && volumes.drawable ? state.pair : null, nodes.map(each => each.slice(0, volumes.most)));
    element('volumes-drawn').textContent = some && !volumes.drawable ? `${drawn().volume}: not a shape that can be drawn here.` : words;
  }

  function draw() {
    for (let k = 0; k < poses.length; ++k) data.poses[k] = k % 7 < 3 ? poses[k] - middle[k % 7] : poses[k];
    touching = answer();
    scene.put(0);
    scene.paint(touching, state.pair);
    showVolumes();
    showLines();
    element('frame').value = state.frame;
    element('frame-number').textContent = state.free || data.motionFrames < 2 ? 'by hand'
      : `frame ${whole.format(state.frame)} of ${whole.format(data.motionFrames)}`;
    element('pair-hint').textContent = sentence();
    const hits = new Set(runs.filter(run => run.number !== null && run.counts).map(run => run.counts.hits));
    element('agreement').textContent = hits.size > 1 ? 'They find different answers: that is a fault; please report it.'
      : runs.length > 1 ? 'All find the same.' : '';
    const alike = new Set(runs.map(({ volume, kernel }) => volume + kernel)).size === 1;
    for (const run of runs) {
      run.line.firstChild.textContent = run.strategy + (['deferred', 'raise'].includes(run.strategy) ? ' (a separation list)' : '')
        + (alike ? '' : `, ${run.volume}, ${run.kernel}`);
      const { text, part } = curves.tests(run, runs), [bar, number] = run.line.lastChild.children;
      bar.style.width = `${80 * part}%`, number.textContent = run.number === null ? '' : text;
      run.numbers.innerHTML = run.number === null ? '' : curves.said(run, runs);
    }
    self.drawn = true;
  }
  function sentence() {
    if (state.waiting !== null) return `Body ${state.waiting} and …`;
    if (!state.pair) return 'Click two bodies to choose a pair.';
    const p = data.numberOf(...state.pair), [i, j] = state.pair;
    const apart = element('query').value === 'distance' && drawn().number !== null ? self.engine.distances(drawn().number)[p] : 0;
    return `Bodies ${i} and ${j} ` + (touching.has(p) ? 'touch.' : apart > 0 ? `are ${apart.toPrecision(6)} apart.` : 'do not touch.');
  }

  // Pair
  /** The pair whose middles are nearest, in the mean of twenty frames, for their sizes. */
  function nearest() {
    const frames = Array.from({ length: 20 }, (_, k) => data.frameOf(Math.floor(k * data.motionFrames / 20))), least = { gap: Infinity, pair: [0, 1] };
    const middles = frames.map(frame => Array.from({ length: data.objects }, (_, i) =>
      add3(Array.from(frame.subarray(7 * i, 7 * i + 3)), rotated(boxOf(i).centre, frame.subarray(7 * i + 3, 7 * i + 7)))));
    for (let i = 0; i < data.objects; ++i) for (let j = i + 1; j < data.objects; ++j) {
      const gap = middles.reduce((sum, at) => sum + Math.hypot(...add3(at[i], at[j], -1)), 0) / 20 / (boxOf(i).radius + boxOf(j).radius);
      if (gap < least.gap) Object.assign(least, { gap, pair: [i, j] });
    }
    return least.pair;
  }
  function choose(pair) {
    if (pair && (pair[0] === pair[1] || pair.some(i => !(i < data.objects)))) pair = null;
    state.pair = pair && [Math.min(...pair), Math.max(...pair)];
    state.waiting = null;
    if (state.pair) element('first').value = state.pair[0], element('second').value = state.pair[1];
    watch();
    // The engine gives the front from the next frame on.
    changed();
  }

  // Time
  function play(on) {
    state.shaken = null;
    state.playing = on && data.motionFrames > 1;
    if (state.playing && (state.free || state.frame === data.motionFrames - 1)) seek(state.free ? state.frame : 0);
    element('play').textContent = state.playing ? 'Pause' : 'Play';
  }
  function byHand() {
    play(false);
    state.free = true;
  }

  // The hand
  let trail = [];
  const turning = event => element('drag').value === 'turns' || event.shiftKey;
  function begin(body) {
    byHand();
    state.held = body, trail = [];
    Object.assign(speeds[body], { way: [0, 0, 0], turn: [0, 0, 0] });
  }
  function move(way, [x, y], event) {
    const [right, up] = scene.directions();
    const turn = turning(event) ? add3(up.map(c => c * x / 150), right, y / 150) : [0, 0, 0];
    if (turning(event)) way = [0, 0, 0];
    trail.push({ way, turn, at: performance.now() });
    moveBody(state.held, way, turn);
    playNow();
  }
  /** Let go in motion: it goes on as it went in the last tenth of a second. */
  function end() {
    const now = performance.now(), last = trail.filter(({ at }) => now - at < 100);
    if (last.length > 1) for (const { way, turn } of last) {
      speeds[state.held].way = add3(speeds[state.held].way, way, 10);
      speeds[state.held].turn = add3(speeds[state.held].turn, turn, 10);
    }
    state.held = null;
  }
  function fly(seconds) {
    let flying = false;
    const reach = Math.max(...Array.from({ length: data.objects }, (_, i) => Math.hypot(...add3(Array.from(data.frameOf(0).subarray(7 * i, 7 * i + 3)), middle, -1)))) + 3 * largest;
    speeds.forEach((speed, i) => {
      if (i === state.held || (Math.hypot(...speed.way) < 1e-3 * largest && Math.hypot(...speed.turn) < 1e-2)) return;
      const out = add3(centreOf(i), middle, -1), far = Math.hypot(...out), outward = dot3(out, speed.way);
      if (far > reach && outward > 0) speed.way = add3(speed.way, out, -2 * outward / (far * far));
      moveBody(i, speed.way.map(x => x * seconds), speed.turn.map(x => x * seconds));
      for (const name of ['way', 'turn']) speed[name] = speed[name].map(x => x * Math.exp(-0.7 * seconds));
      flying = true;
    });
    if (flying) playNow();
  }
  /** Plays the motion; without one, the first body of the pair drifts past the other and turns. */
  function slowly() {
    if (data.motionFrames > 1) return play(true);
    byHand();
    const way = unit3(add3(centreOf(state.pair?.[1] ?? 0), centreOf(selected()), -1));
    Object.assign(speeds[selected()], { way: way.map(x => 0.2 * largest * x), turn: [0.1, 0.2, 0.1] });
  }
  /** Sends the two bodies of the pair away from each other. */
  function part() {
    byHand();
    const [i, j] = state.pair, way = unit3(add3(centreOf(j), centreOf(i), -1));
    for (const [body, sign] of [[i, -1], [j, 1]]) Object.assign(speeds[body], { way: way.map(x => 0.6 * sign * largest * x), turn: [0, 0, 0] });
  }
  /** For a second, the first body of the pair jumps to and fro, and turns. */
  function shake() {
    byHand();
    state.shaken = { body: selected(), frames: 60, turn: Array.from(poseOf(selected())) };
  }
  function shaken() {
    const { body, turn } = state.shaken, k = state.shaken.frames--;
    poseOf(body).set(turn);
    if (k === 0) state.shaken = null;
    else moveBody(body, [1, 2, 3].map(i => 0.25 * largest * Math.sin(i * k * k)), [1, 2, 3].map(i => 0.6 * Math.sin((i + 3) * k * k)));
    playNow();
  }
  const selected = () => state.pair?.[0] ?? 0;
  function key(event) {
    if (event.target.closest?.('input, select') || (event.target.closest?.('button') && event.key === ' ')) return;
    const [right, up, back] = scene.directions() ?? [[1, 0, 0], [0, 0, 1], [0, -1, 0]];
    const ways = { ArrowLeft: right.map(x => -x), ArrowRight: right, ArrowUp: up, ArrowDown: up.map(x => -x), PageUp: back.map(x => -x), PageDown: back };
    const way = ways[event.key], i = selected();
    const about = way && (way === ways.PageUp || way === ways.PageDown ? way : cross3(back, way));
    if (way && event.shiftKey) self.moveBody(i, [0, 0, 0], about.map(x => x / 12));
    else if (way) self.moveBody(i, way.map(x => x * largest / 20));
    else if (event.key === ' ') play(!state.playing);
    else if (event.key === '.' || event.key === ',') self.seek(state.frame + (event.key === '.' ? 1 : -1));
    else if (event.key === 'n' && data.objects > 1) choose([(i + 1) % data.objects, (i + 2) % data.objects]);
    else if (event.key === 't') byHand(), speeds[i].way = back.map(x => -2 * largest * x), speeds[i].turn = up;
    else return;
    event.preventDefault();
  }

  // Controls of a run
  function select(row, label, values, value, act) {
    const menu = made('select', { ariaLabel: label, title: label });
    for (const each of values) menu.append(new Option(typeof each === 'number' ? `fan-out ${each}` : each, each, false, each === value));
    menu.addEventListener('change', () => act(menu.value));
    row.append(menu);
  }
  function controlsOf(run) {
    run.row.replaceChildren();
    const title = 'draw its volumes and its front';
    const draws = made('input', { type: 'radio', name: 'drawn', checked: run === drawn(), title, ariaLabel: title });
    draws.style.accentColor = draws.style.outlineColor = run.colour;
    draws.addEventListener('change', () => { runs.forEach(each => { each.isDrawn = each === run; }), changed(); });
    run.row.append(draws);
    const change = what => {
      Object.assign(run, what);
      const kernel = offered[run.kernel];
      for (const [name, values] of [['volume', kernel.volumes], ['strategy', kernel.strategies], ['fanOut', kernel.fanOuts]])
        if (!values.includes(run[name])) run[name] = values[0];
      controlsOf(run);
      changed();
    };
    const kernel = offered[run.kernel];
    select(run.row, 'strategy', kernel.strategies, run.strategy, strategy => change({ strategy }));
    select(run.row, 'volume', kernel.volumes, run.volume, volume => change({ volume }));
    select(run.row, 'kernel', Object.keys(offered), run.kernel, name => change({ kernel: name }));
    select(run.row, 'fan-out', kernel.fanOuts, run.fanOut, fanOut => change({ fanOut: Number(fanOut) }));
    if (run !== runs[0]) {
      const away = made('button', { type: 'button', textContent: '×', ariaLabel: 'take it away' });
      away.addEventListener('click', () => {
        if (run.number !== null) self.engine.endRun(run.number);
        runs.splice(runs.indexOf(run), 1);
        run.row.remove(), run.line.remove();
        if (run.isDrawn) runs[0].row.querySelector('input').click();
        draw();
      });
      run.row.append(away);
    }
    run.line.style.color = run.colour;
    run.row.append(run.said, run.numbers);
  }
  /** Another strategy, volume, kernel, fan-out or query: the motion is played again up to here, so that numbers are
   *  those of one strategy from the first frame on. By hand there is no motion: it goes on from here. */
  function changed() {
    const free = state.free;
    state.free = true;
    if (free) restart(), playNow();
    else seek(state.frame);
  }
  function addRun(what = {}) {
    const used = runs.map(run => run.colour), colour = colours.map(name => look.colour(name)).find(each => !used.includes(each));
    if (!colour) return;
    const run = { strategy: 'margins', volume: 'sphere', kernel: 'gathered', fanOut: 2, ...what, colour, number: null, past: [], times: [],
      row: made('p', { className: 'row run' }), said: made('small'), numbers: made('span'), line: made('span') };
    run.line.append(made('span'), made('span'));
    run.line.lastChild.append(made('i'), made('output'));
    element('lines').append(run.line);
    element('runs').append(run.row);
    runs.push(run);
    controlsOf(run);
    return run;
  }
  self.addRun = what => { addRun(what), changed(); };

  let last = performance.now();
  function tick(now) {
    const seconds = Math.min(0.05, (now - last) / 1000);
    last = now;
    try {
      if (state.playing) {
        seek(state.frame + 1);
        if (state.frame === data.motionFrames - 1) play(false);
      } else {
        state.shaken ? shaken() : fly(seconds);
      }
      scene.draw();
      if (self.drawn) curves.draw(runs, drawn()), self.drawn = false;
    } catch (error) {
      return problem(`The engine stopped: ${error.message}`);
    }
    requestAnimationFrame(tick);
  }

  async function begins() {
    document.title = element('title').textContent = `bvlab live · ${data.title}`;
    element('facts').textContent = `${whole.format(data.objects)} bodies, ${whole.format(data.triangles)} triangles`;
    showLeftOut(data.left_out);
    self.engine = await engineFrom(data.engine);
    data.meshes.forEach(mesh => self.engine.addMesh(mesh.exact, mesh.triangles));
    self.engine.setBodies(data.objects);
    offered = {
      gathered: { volumes: ['sphere', 'obb'], strategies: ['recursive', 'separation-list', 'deferred', 'raise', 'margins'], fanOuts: [2, 4, 8, 16] },
      siblings: { volumes: ['slab-box'], strategies: ['recursive', 'margins'], fanOuts: [self.engine.lanes] },
      mixed: { volumes: ['slab-box'], strategies: ['recursive', 'margins'], fanOuts: [4] },
    };
    for (const query of ['touching', 'contacts', 'distance']) element('query').append(new Option(query));
    element('query').value = data.query;
    for (const name of ['first', 'second']) for (let i = 0; i < data.objects; ++i) element(name).append(new Option(i));
    data.runs.forEach(run => addRun(run));
    element('frame').max = data.motionFrames - 1;
    for (const id of ['play', 'back', 'step', 'frame']) element(id).disabled = data.motionFrames < 2;
    state.free = true;  // until the motion has been taken from its beginning
    seek(0);
    if (data.objects > 1) choose(nearest());
    scene.lookAt(null);
    connect();
    self.ready = true;
    requestAnimationFrame(tick);
  }

  function connect() {
    element('play').addEventListener('click', () => play(!state.playing));
    element('back').addEventListener('click', () => self.seek(state.frame - 1));
    element('step').addEventListener('click', () => self.seek(state.frame + 1));
    element('frame').addEventListener('input', event => self.seek(Number(event.target.value)));
    element('query').addEventListener('change', changed);
    element('add-run').addEventListener('click', () => self.addRun());
    element('part').addEventListener('click', () => { if (state.pair) part(); });
    element('shake').addEventListener('click', shake);
    element('slowly').addEventListener('click', slowly);
    if (data.motionFrames > 1) element('slowly').textContent = 'Play the motion';
    element('look').addEventListener('click', () => scene.lookAt(state.pair));
    for (const id of ['first', 'second'])
      element(id).addEventListener('change', () => choose([Number(element('first').value), Number(element('second').value)]));
    onWhich(draw);
    addEventListener('keydown', key);
    scene.onClick(body => {
      if (body === null || body === state.waiting) state.waiting = null;
      else if (state.waiting === null) state.waiting = body;
      else return choose([state.waiting, body]);
      element('pair-hint').textContent = sentence();
    });
    scene.onDrag({ begin, move, end });
    look.onChange(() => runs.forEach((run, k) => { run.colour = look.colour(colours[k % colours.length]), controlsOf(run); }));
  }

  begins().catch(error => problem(error.message));
  return self;
})();
