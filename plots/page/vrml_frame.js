// SPDX-License-Identifier: BSD-3-Clause
// Turns VRML 97 into X3D by X_ITE, in a frame that reaches neither page nor network: what x3d.js puts into it.
'use strict';

// X_ITE looks for files beside its script, which has no address here: they are not needed.
window.URL = class extends URL { constructor(path, base) { super(path, base?.startsWith('about:') ? 'https://bvlab.invalid/' : base); } };
// Nor is there storage in such a frame, in which X_ITE would keep its settings.
Object.defineProperty(window, 'localStorage', { value: { getItem: () => null, setItem() {} } });
addEventListener('error', event => parent.postMessage({ problem: event.message }, '*'));
addEventListener('message', async ({ data, source }) => {
  const answer = {};
  try {
    new Function(data.viewer)();
    const browser = X3D.getBrowser(document.body.appendChild(X3D.createBrowser()));
    browser.loadComponents = async () => {};
    browser.setBrowserOption('LoadUrlObjects', false);
    answer.x3d = (await browser.createX3DFromString(data.text)).toXMLString();
  } catch (error) {
    answer.problem = error.message;
  }
  source.postMessage(answer, '*');
});
