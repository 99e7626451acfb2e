// SPDX-License-Identifier: BSD-3-Clause
// The part of three.js that pages use, as a plain script: a page that is opened from a file cannot load modules.
export { BufferAttribute, BufferGeometry, DirectionalLight, DoubleSide, Group, HemisphereLight, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, MeshLambertMaterial, PerspectiveCamera, Quaternion, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer } from 'three';
export { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
