// SPDX-License-Identifier: BSD-3-Clause
// The user's scene, in x3dom, with a sensor for each part that has none. Of the file only nodes that x3dom knows come
// into the page, without addresses, scripts and handlers: nothing in it is executed or fetched.
'use strict';

/** VRML 97 as X3D: X_ITE reads it, in a frame of its own without a network (vrml_frame.js). */
function fromVrml(text, viewer, script) {
  const frame = document.createElement('iframe'), most = 30;
  frame.setAttribute('sandbox', 'allow-scripts');
  // Where nothing is drawn, X_ITE waits for ever for the next frame.
  frame.style = 'position: fixed; top: 0; left: 0; width: 2px; height: 2px; border: 0; opacity: 0.01';
  frame.srcdoc = `<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'">`
    + `<body><script>${script}<\/script>`;
  return new Promise((done, refuse) => {
    setTimeout(() => refuse(Error(`This VRML was not read within ${most} seconds.`)), 1000 * most);
    frame.addEventListener('load', () => frame.contentWindow.postMessage({ text, viewer }, '*'));
    addEventListener('message', ({ data, source }) => {
      if (source !== frame.contentWindow) return;
      frame.remove();
      if (data.x3d) done(data.x3d);
      else refuse(Error(`This VRML cannot be read here: ${data.problem}`));
    });
    document.body.append(frame);
  });
}

const page = { contact: null };
(async () => {
  const data = JSON.parse(element('data').textContent);
  document.title = element('title').textContent = `bvlab in an X3D browser · ${data.title}`;
  if (typeof x3dom === 'undefined') return problem('This page was made without x3dom, which shows X3D: experiments/setup gets it from npm.');
  // It writes parts of a file into its log as HTML, and a WorldInfo's words are logged.
  x3dom.debug.doLog = () => {};
  if (!document.createElement('canvas').getContext('webgl')) return problem('This browser shows no 3D here: WebGL is off or missing.');
  if (data.scene.startsWith('#VRML V2.0')) {
    if (!data.vrml_reader) return problem('This page was made without X_ITE, which reads VRML: experiments/setup gets it from npm.');
    data.scene = await fromVrml(data.scene, new TextDecoder().decode(await unzipped(data.vrml_reader)), data.vrml_frame);
  }
  const read = new DOMParser().parseFromString(data.scene, 'text/xml'), given = read.querySelector('Scene, scene');
  if (read.querySelector('parsererror') || !given) return problem(`${data.title} is no X3D that can be read here: XML with a Scene is needed, or VRML 97 (#VRML V2.0).`);

  const refused = new Set(['anchor', 'inline', 'script', 'composedshader', 'shaderpart', 'externalshape', 'externalgeometry', 'multipart', 'remoteselectiongroup']);
  const attribute = /^(?!on|url|href|src|style|id$|class$|is$)[a-z][a-z0-9_]*$/i;
  function copied(from) {
    const name = from.localName.toLowerCase();
    if (name !== 'scene' && name !== 'route' && (refused.has(name) || !x3dom.nodeTypesLC[name])) return null;
    const to = document.createElement(name);
    for (const { name, value } of from.attributes) if (attribute.test(name)) to.setAttribute(name, value);
    for (const child of from.children) {
      const part = copied(child);
      if (part) to.append(part);
    }
    if (name === 'shape' && !to.querySelector('material')) {
      const appearance = to.querySelector('appearance') ?? to.appendChild(document.createElement('appearance'));
      appearance.append(document.createElement('material'));
    }
    return to;
  }
  const scene = copied(given);

  // A sensor beside each part, in the plane of x and y, unless the scene has sensors of its own.
  if (!scene.querySelector('planesensor, cylindersensor, spheresensor'))
    [...scene.querySelectorAll('transform')].filter(part => !part.parentElement.closest('transform') && part.querySelector('shape'))
      .forEach((part, k) => {
        const [group, sensor, route] = ['group', 'planesensor', 'route'].map(name => document.createElement(name));
        const name = part.getAttribute('DEF') ?? `bvlab-part-${k}`;
        part.setAttribute('DEF', name);
        sensor.setAttribute('DEF', `${name}-sensor`);
        sensor.setAttribute('autoOffset', 'true');
        sensor.setAttribute('offset', part.getAttribute('translation') ?? '0 0 0');
        for (const [key, value] of [['fromNode', `${name}-sensor`], ['fromField', 'translation_changed'], ['toNode', name], ['toField', 'set_translation']])
          route.setAttribute(key, value);
        part.replaceWith(group);
        group.append(sensor, part);
        scene.append(route);
      });
  const x3d = document.createElement('x3d');
  x3d.setAttribute('showLog', 'false');
  x3d.append(scene);
  element('stage').append(x3d);

  const ready = () => [...x3d.querySelectorAll('shape')].every(shape => shape._x3domNode?._cf.geometry?.node?._mesh?._positions?.[0]?.length > 0);
  const begun = performance.now(), patience = 10000;
  const names = part => part.getAttribute('DEF') ?? 'a part';
  async function attach() {
    // A shape may stay empty: it is not waited for.
    if (!x3d.runtime || (!ready() && performance.now() - begun < patience)) return void setTimeout(attach, 30);
    try {
      x3d.runtime.showAll?.('negZ');
      page.contact = await bvlabX3d(x3d, await engineFrom(data.engine), {
        onChange: pairs => {
          const { parts } = page.contact ?? { parts: [] };
          element('said').textContent = pairs.length === 0 ? 'Nothing touches. Drag a part: what it touches turns red.'
            : pairs.map(([i, j]) => parts.length ? `${names(parts[i])} touches ${names(parts[j])}` : 'Parts touch').join(', ');
        } });
    } catch (error) {
      problem(error.message);
    }
  }
  if (document.readyState === 'complete') x3dom.reload(), attach();
  else addEventListener('load', () => attach());
})().catch(error => problem(error.message));
