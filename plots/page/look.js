// SPDX-License-Identifier: BSD-3-Clause
// What all pages share. Light or dark: as the system says until the button is used; what was chosen is kept.
'use strict';

const element = id => document.getElementById(id);
/** An element of that kind, with properties. */
const made = (kind, properties) => Object.assign(document.createElement(kind), properties);
function problem(sentence) {
  element('problem').textContent = sentence;
  element('problem').hidden = false;
}
/** What a page leaves out, in sentences; no section where that is nothing. */
function showLeftOut(sentences) {
  element('left-out').append(...sentences.map(textContent => made('li', { textContent })));
  element('left-out-section').hidden = sentences.length === 0;
}

const look = (() => {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const listeners = [];
  // A page opened from a file may have no storage.
  const stored = () => { try { return localStorage.getItem('theme'); } catch { return null; } };
  const store = theme => { try { localStorage.setItem('theme', theme); } catch { /* not kept */ } };
  const apply = theme => {
    document.documentElement.dataset.theme = theme;
    for (const listener of listeners) listener();
  };
  apply(stored() ?? (system.matches ? 'dark' : 'light'));
  system.addEventListener('change', () => { if (!stored()) apply(system.matches ? 'dark' : 'light'); });
  element('theme').addEventListener('click', () => {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    store(theme);
    apply(theme);
  });
  return {
    colour: name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim(),
    onChange: listener => listeners.push(listener),
  };
})();
