// SPDX-License-Identifier: BSD-3-Clause
// What the last frames cost, one curve for each strategy.
'use strict';

const curves = (() => {
  const kept = 600, count = new Intl.NumberFormat('en', { maximumSignificantDigits: 6 });
  const kinds = [['N<sub>u</sub>', 'volumes posed'], ['N<sub>v</sub>', 'volume tests'], ['N<sub>p</sub>', 'triangle tests'],
                 ['front', 'pairs kept'], ['hits', ''], ['N<sub>b</sub>', 'body tests'], ['ms', 'time']];
  const boxes = kinds.map(([symbol, meaning]) => {
    const innerHTML = `<h3><span>${meaning}</span></h3><p>${symbol} <output></output><span></span></p><canvas></canvas>`;
    const box = made('div', { className: 'curve', innerHTML });
    element('curves').append(box);
    return { box, canvas: box.querySelector('canvas'), output: box.querySelector('output'), most: box.querySelector('p span') };
  });
  const rough = new Intl.NumberFormat('en', { maximumSignificantDigits: 3 });
  const format = (value, k) => (kinds[k][0] === 'ms' ? rough : count).format(value);
  const lastOf = (run, k) => run?.past.at(-1)?.[k] ?? NaN;

  function drawOne({ box, canvas, output, most }, k, runs, shown) {
    if (box.hidden) return;
    output.textContent = format(lastOf(shown, k), k);
    output.style.color = shown.colour;
    const { width, height } = canvas.getBoundingClientRect(), scale = devicePixelRatio;
    canvas.width = Math.max(1, Math.round(width * scale)), canvas.height = Math.max(1, Math.round(height * scale));
    const pen = canvas.getContext('2d');
    // The first times are those of a browser that still compiles.
    const from = kinds[k][0] === 'ms' ? Math.min(20, runs[0].past.length >> 1) : 0;
    const top = Math.max(...runs.map(run => run.past.slice(from).reduce((a, values) => Math.max(a, values[k]), 0))) || 1;
    most.textContent = `, to ${format(top, k)}`;
    pen.lineWidth = 1.25 * scale;
    const across = Math.max(120, ...runs.map(run => run.past.length)) - 1;
    for (const run of [...runs].reverse()) {
      pen.strokeStyle = run.colour;
      pen.beginPath();
      run.past.forEach((values, at) =>
        pen.lineTo(at / across * canvas.width, canvas.height - scale - values[k] / top * (canvas.height - 3 * scale)));
      pen.stroke();
    }
  }

  return {
    /** Of a run: N_u, N_v, N_p, front, hits, N_b, milliseconds. */
    add(run, values) {
      run.past.push(values);
      if (run.past.length > kept) run.past.shift();
    },
    /** Numbers are those of the run that is shown. */
    draw(runs, shown) {
      // What is hidden leaves its room to the others, which is measured after that.
      boxes.forEach(({ box }, k) => { box.hidden = kinds[k][0] === 'hits' || !runs.some(run => run.past.some(values => values[k] > 0)); });
      boxes.forEach((box, k) => drawOne(box, k, runs, shown));
    },
    /** A run's last frame, as HTML; and how its frames compare with those of recursion. */
    said(run, runs) {
      if (Number.isNaN(lastOf(run, 1))) return '';
      const base = runs.find(({ strategy, number }) => strategy === 'recursive' && number !== null);
      const sum = ({ past }, k) => past.reduce((all, values) => all + values[k], 0);
      return (!base || run === base ? '' : `<b>${rough.format(sum(run, 1) / sum(base, 1))}</b> of the volume tests of recursive so far, <b>${
        rough.format(lastOf(run, 6) / lastOf(base, 6))}</b> of its time<br>`)
        + [2, 3].map(k => `${kinds[k][0]} ${format(lastOf(run, k), k)} · `).join('') + `${format(lastOf(run, 6), 6)} ms`;
    },
    /** A run's volume tests in its last frame, and as a part of the most that a run has made. */
    tests(run, runs) {
      const most = Math.max(...runs.map(each => lastOf(each, 1) || 0));
      return { text: Number.isNaN(lastOf(run, 1)) ? '' : format(lastOf(run, 1), 1), part: most > 0 ? (lastOf(run, 1) || 0) / most : 0 };
    },
  };
})();
