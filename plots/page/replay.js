// SPDX-License-Identifier: BSD-3-Clause
// What the controls do.
'use strict';

(() => {
  const framesPerSecond = 30;
  const state = { frame: 0, playing: false, due: 0, pair: null, waiting: null };
  const count = new Intl.NumberFormat('en');

  // Words
  document.title = element('title').textContent = `${data.trace} · ${data.volume} · ${data.strategy}`;
  element('facts').textContent =
    `${count.format(data.objects)} bodies of ${[...new Set(data.meshes.map(m => m.name))].slice(0, 4).join(', ')}, ` +
    `${count.format(data.triangles)} triangles, ${count.format(data.frames)} frames; ${data.query}, built ${data.build}`;
  const swatch = (colour, words) => `<span><i style="background:var(--${colour})"></i>${words}</span>`;
  element('legend').innerHTML = swatch('touching', 'touching');
  showLeftOut(data.leftOut);

  // Frames
  const numberOf = f => f * data.stride;
  function show(f) {
    state.frame = Math.min(Math.max(0, f), Math.max(0, data.frames - 1));
    element('frame').value = state.frame;
    element('frame-number').textContent =
      data.frames ? `frame ${count.format(numberOf(state.frame))} of ${count.format(numberOf(data.frames))}` : 'no frames';
    scene.put(state.frame);
    paint();
    curves.show(state.frame);
    if (state.pair && (which() === 'front' || volumes.realigned)) showVolumes();
    else scene.placeVolumes(state.pair);
  }
  const touchingNow = () => data.touching[state.frame] ?? [];
  function paint() {
    scene.paint(touchingNow(), state.pair);
    markPairs();
  }

  // Pairs
  const cells = new Map();
  const asMatrix = data.objects <= 16;
  function cell(p) {
    const [i, j] = data.pairOf(p), title = `bodies ${i} and ${j}`, button = made('button', { type: 'button', title, ariaLabel: title });
    button.dataset.pair = p;
    if (!asMatrix) button.textContent = `${i}–${j}`;
    button.addEventListener('click', () => choose(state.pair && data.numberOf(...state.pair) === p ? null : [i, j]));
    cells.set(p, button);
    return button;
  }
  function makeMatrix() {
    const box = element('pairs'), n = data.objects, label = textContent => made('span', { textContent });
    box.className = 'matrix';
    box.style.gridTemplateColumns = `1.4em repeat(${n - 1}, minmax(0, 1fr))`;
    box.append(label(''));
    for (let j = 1; j < n; ++j) box.append(label(j));
    for (let i = 0; i + 1 < n; ++i) {
      box.append(label(i));
      for (let j = 1; j < n; ++j) box.append(j > i ? cell(data.numberOf(i, j)) : label(''));
    }
  }
  function markPairs() {
    const touching = new Set(touchingNow()), chosen = state.pair ? data.numberOf(...state.pair) : -1;
    if (!asMatrix) {
      const box = element('pairs'), listed = [...touching].slice(0, 200);
      if (chosen >= 0 && !touching.has(chosen)) listed.unshift(chosen);
      const wanted = listed.join();
      if (box.dataset.listed !== wanted) {
        box.dataset.listed = wanted;
        cells.clear();
        box.replaceChildren(...listed.map(cell));
      }
    }
    for (const [p, button] of cells) {
      button.classList.toggle('touching', touching.has(p));
      button.setAttribute('aria-pressed', p === chosen);
    }
    element('pair-hint').textContent = state.pair
      ? `Bodies ${state.pair[0]} and ${state.pair[1]}` + (touching.has(chosen) ? ' touch.' : ' do not touch.')
      : state.waiting !== null ? `Body ${state.waiting} and …`
      : data.objects < 2 ? 'There is but one body.'
      : `${count.format(touching.size)} of ${count.format(data.pairCount)} pairs touch. Choose one to see its volumes.`;
  }
  if (asMatrix && data.objects > 1) makeMatrix();
  else element('pairs').className = 'list';

  function choose(pair) {
    state.pair = pair;
    state.waiting = null;
    element('look').disabled = element('no-pair').disabled = pair === null;
    const front = document.querySelector('input[value="front"]');
    front.disabled = !data.keepsFronts;
    front.parentElement.title = data.keepsFronts ? 'the nodes that the front stands on' : `${data.strategy} keeps no front`;
    element('legend').innerHTML = swatch('touching', 'touching') +
      (pair ? swatch('first', `volumes of body ${pair[0]}`) + swatch('second', `of body ${pair[1]}`) : '');
    if (pair) {
      const deepest = Math.max(...pair.map(i => data.meshOf(i).deepest));
      element('level').max = deepest;
      element('level').disabled = which() !== 'level';
    }
    paint();
    showVolumes();
  }
  scene.onClick(body => {
    if (body === null || body === state.waiting) state.waiting = null;
    else if (state.waiting === null) state.waiting = body;
    else return choose([Math.min(body, state.waiting), Math.max(body, state.waiting)]);
    if (state.waiting === null) return choose(null);
    markPairs();
  });
  element('no-pair').addEventListener('click', () => choose(null));
  element('look').addEventListener('click', () => scene.lookAt(state.pair));

  // Volumes
  /** The nodes of the pair's two bodies whose volumes are to be drawn, and what they are. */
  function nodesNow() {
    if (!state.pair || which() === 'none') return [[[], []], ''];
    if (which() === 'level') {
      const level = Number(element('level').value);
      return [state.pair.map(i => volumes.level(data.meshIndexOf(i), level)), `level ${level} of each body`];
    }
    const front = data.front(data.numberOf(...state.pair));
    if (!front) return [[[], []], 'Of this pair no front is in this page.'];
    const nodes = [[], []];
    for (const number of front[state.frame]) nodes[number & 1].push(number >> 1);
    return [nodes, nodes[0].length ? 'nodes that the front stands on' : 'No front is kept in this frame.'];
  }
  function showVolumes() {
    showLevel();
    let [nodes, words] = nodesNow();
    const full = nodes.map(n => n.length);
    nodes = nodes.map(n => n.slice(0, volumes.most));
    scene.showVolumes(volumes.drawable ? state.pair : null, nodes);
    const cut = full.some((n, side) => n > nodes[side].length);
    element('volumes-drawn').textContent =
      !state.pair ? `Shown once a pair is chosen (${data.volume}).`
      : !volumes.drawable ? `${data.volume}: not a shape that can be drawn here.`
      : full[0] + full[1] === 0 ? words
      : `${words}: ${nodes[0].length} + ${nodes[1].length} volumes (${data.volume})` + (cut ? `, the first of ${full[0]} + ${full[1]}` : '');
  }
  onWhich(showVolumes);

  // Time
  function play(on) {
    state.playing = on && data.frames > 1;
    if (state.playing && state.frame === data.frames - 1) show(0);
    state.due = 0;
    element('play').textContent = state.playing ? 'Pause' : 'Play';
  }
  const pause = f => { play(false); show(f); };
  element('play').addEventListener('click', () => play(!state.playing));
  element('frame').addEventListener('input', event => pause(Number(event.target.value)));
  curves.onScrub(pause);
  for (const speed of [0.1, 0.25, 0.5, 1, 2, 4])
    element('speed').append(new Option(`${speed}×`, speed, speed === 1, speed === 1));
  addEventListener('keydown', event => {
    if (event.target.closest('input, select') || (event.target.closest('button') && event.key === ' ')) return;
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === ' ') play(!state.playing);
    else if (step) pause(state.frame + step);
    else return;
    event.preventDefault();
  });

  let last = performance.now();
  function tick(now) {
    // After a pause of the browser the film goes on where it was.
    const elapsed = Math.min(0.5, (now - last) / 1000);
    last = now;
    if (state.playing) {
      state.due += elapsed * framesPerSecond * Number(element('speed').value);
      const steps = Math.floor(state.due);
      if (steps > 0) {
        state.due -= steps;
        show(state.frame + steps);
        if (state.frame === data.frames - 1) play(false);
      }
    }
    scene.draw();
    requestAnimationFrame(tick);
  }

  element('frame').max = Math.max(0, data.frames - 1);
  choose(null);
  show(0);
  requestAnimationFrame(tick);
})();
