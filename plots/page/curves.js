// SPDX-License-Identifier: BSD-3-Clause
// What each frame cost, over time, in step with the scene.
'use strict';

const curves = (() => {
  const kinds = [['N<sub>u</sub>', 'volumes posed'], ['N<sub>v</sub>', 'volume tests'],
                 ['N<sub>p</sub>', 'triangle tests'], ['front', 'entries']];
  const count = new Intl.NumberFormat('en');
  const all = kinds.map(([symbol, meaning], k) => {
    const innerHTML = `<h3><span>${symbol} <small>${meaning}</small></span><output></output></h3><canvas></canvas>`;
    const box = made('div', { className: 'curve', innerHTML });
    element('curves').append(box);
    const values = Float64Array.from({ length: data.frames }, (_, f) => data.series[4 * f + k]);
    return { values, most: values.reduce((a, b) => Math.max(a, b), 0) || 1, canvas: box.querySelector('canvas'),
             output: box.querySelector('output'), still: document.createElement('canvas') };
  });
  let frame = 0;

  /** The curve without the mark of the frame, drawn once: of each column of pixels least and most. */
  function drawStill({ values, most, canvas, still }) {
    const { width, height } = canvas.getBoundingClientRect(), scale = devicePixelRatio;
    still.width = canvas.width = Math.max(1, Math.round(width * scale));
    still.height = canvas.height = Math.max(1, Math.round(height * scale));
    const pen = still.getContext('2d'), across = still.width - 2 * scale, up = still.height - 12 * scale;
    const y = value => still.height - scale - value / most * up;
    pen.strokeStyle = look.colour('line');
    pen.lineWidth = scale;
    for (const value of [0, most]) {
      pen.beginPath(), pen.moveTo(0, y(value)), pen.lineTo(still.width, y(value)), pen.stroke();
    }
    pen.fillStyle = look.colour('faint');
    pen.font = `${10 * scale}px sans-serif`;
    pen.fillText(count.format(most), 2 * scale, 9 * scale);
    pen.strokeStyle = look.colour('accent');
    pen.lineWidth = 1.25 * scale;
    pen.lineJoin = 'round';
    pen.beginPath();
    const columns = Math.min(values.length, Math.floor(across));
    for (let c = 0; c < columns; ++c) {
      const from = Math.floor(c * values.length / columns), to = Math.max(from + 1, Math.floor((c + 1) * values.length / columns));
      let low = Infinity, high = -Infinity;
      for (let f = from; f < to; ++f) low = Math.min(low, values[f]), high = Math.max(high, values[f]);
      const x = scale + (columns > 1 ? c / (columns - 1) : 0.5) * across;
      pen.lineTo(x, y(low));
      if (high > low) pen.lineTo(x, y(high));
    }
    pen.stroke();
  }
  function mark(curve) {
    const { canvas, still, values, output, most } = curve, pen = canvas.getContext('2d'), scale = devicePixelRatio;
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(still, 0, 0);
    if (values.length === 0) return;
    const x = scale + (values.length > 1 ? frame / (values.length - 1) : 0.5) * (canvas.width - 2 * scale);
    const y = canvas.height - scale - values[frame] / most * (canvas.height - 12 * scale);
    pen.strokeStyle = pen.fillStyle = look.colour('touching');
    pen.lineWidth = scale;
    pen.beginPath(), pen.moveTo(x, 0), pen.lineTo(x, canvas.height), pen.stroke();
    pen.beginPath(), pen.arc(x, y, 3 * scale, 0, 2 * Math.PI), pen.fill();
    output.textContent = count.format(values[frame]);
  }
  const redraw = () => all.forEach(curve => { drawStill(curve), mark(curve); });
  look.onChange(redraw);
  new ResizeObserver(redraw).observe(element('curves'));
  redraw();

  return {
    show: f => { frame = f, all.forEach(mark); },
    /** Calls back with the frame that is pointed at while the pointer is down. */
    onScrub(act) {
      for (const { canvas } of all) {
        const at = event => {
          const { left, width } = canvas.getBoundingClientRect();
          act(Math.round(Math.min(1, Math.max(0, (event.clientX - left) / width)) * Math.max(0, data.frames - 1)));
        };
        canvas.addEventListener('pointerdown', event => { canvas.setPointerCapture(event.pointerId), at(event); });
        canvas.addEventListener('pointermove', event => { if (event.buttons & 1) at(event); });
      }
    },
  };
})();
