// SPDX-License-Identifier: BSD-3-Clause
// The drawing of the idea: a tree of pairs, of which a search opens those above the front.
'use strict';

(() => {
  const svg = document.getElementById('idea');
  const add = (name, attributes, text = '') => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    svg.append(made);
  };
  // Nodes as in a heap, the roots first; those in `opened` overlap.
  const opened = new Set([1, 2, 3, 5, 6, 10, 11, 12]), depths = 5;
  const isFront = node => node > 1 && opened.has(node >> 1) && !opened.has(node);
  const depthOf = node => 31 - Math.clz32(node);
  const at = node => [20 + 200 * (node - 2 ** depthOf(node) + 0.5) / 2 ** depthOf(node), 12 + 22 * depthOf(node)];
  for (let node = 2; node < 2 ** depths; ++node) {
    const [x, y] = at(node), [a, b] = at(node >> 1);
    add('path', { d: `M${a} ${b}L${x} ${y}`, class: opened.has(node >> 1) ? 'reached' : 'below' });
  }
  const front = Array.from({ length: 2 ** depths }, (_, node) => node).filter(isFront).sort((a, b) => at(a)[0] - at(b)[0]);
  add('path', { d: `M${front.map(node => at(node).join(' ')).join('L')}`, class: 'front-line' });
  for (let node = 1; node < 2 ** depths; ++node) {
    const [cx, cy] = at(node), kind = isFront(node) ? 'front' : opened.has(node) ? 'opened' : 'below';
    add('circle', { cx, cy, r: kind === 'below' ? 1.6 : 3.6, class: kind });
  }
  for (const [y, text, kind] of [[16, 'the roots:', ''], [29, 'recursion starts', ''], [58, 'the front:', 'of-front'], [71, 'a list starts', 'of-front'],
    [104, 'never reached', 'faint']])
    add('text', { x: 232, y, class: kind }, text);
})();
