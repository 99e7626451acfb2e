// SPDX-License-Identifier: BSD-3-Clause
// Light or dark: as the system says until the button is used; what was chosen is kept.
'use strict';

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
  document.getElementById('theme').addEventListener('click', () => {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    store(theme);
    apply(theme);
  });
  return {
    colour: name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim(),
    onChange: listener => listeners.push(listener),
  };
})();
