// SPDX-License-Identifier: BSD-3-Clause
// What a web developer has today, as a plain script: `plots/live --peers` asks them what it asks bvlab.
export { BufferAttribute, BufferGeometry, Matrix4, Quaternion, Vector3 } from 'three';
export { MeshBVH } from 'three-mesh-bvh';
export { default as RAPIER } from '@dimforge/rapier3d-compat';
