// What three.js makes of a glTF file: where every vertex lies in the world, at rest, in every animation, and in blends of several.
// Never here: pictures. Images, materials and cameras are taken out before three sees the file, since Node has no DOM.
//
//     node positions.mjs FILE.gltf|glb OUT.bin
//
// OUT.bin gets float32, little-endian, three to a vertex: sample by sample, in each the nodes that have a mesh, depth first with children
// in the file's order, the primitives of a mesh one after another, vertices in the order of their accessor. Standard output gets one line
// of JSON that says what lies there:
//
//     {"samples": [{"clips": [{"index": 0, "time": 1.23, "weight": 1}], "meshes": [{"node": 3, "vertex_count": 120}]}], "size": 2.5}
//
// `size` is the diagonal of the box around all vertices at rest; the first sample, without clips, is that rest.
//
// How three blends (`PropertyMixer.accumulate` and `apply`), for every property of every node by itself, over those clips alone that have a
// channel for it, in the order in which they were started:
//
//     value = value of the first clip; sum = its weight
//     for each further clip: sum += weight; value = mix(value, value of this clip, weight / sum)
//     if sum < 1: value = mix(value, rest, 1 - sum)
//
// `mix` is a + (b - a) t, and for rotations a slerp the shorter way round (b is negated where dot(a, b) < 0; where it is 0.9995 or more, a
// normalised lerp). So numbers come to sum(weight * value) / max(sum, 1), with rest for what is missing to 1, whatever the order;
// rotations of three clips and more depend on the order. A weight of 0 takes no part.

import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { AnimationMixer, Box3, DetachedBindMode, LoopOnce, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const SAMPLES_PER_CLIP = 20;

const GLB_MAGIC = 0x46546c67;
const CHUNK_JSON = 0x4e4f534a;
const CHUNK_BIN = 0x004e4942;

const [file, out] = process.argv.slice(2);
if (!out) {
  console.error('usage: node positions.mjs FILE.gltf|glb OUT.bin');
  process.exit(2);
}
const { scene, clips, nodes } = await load(file);
const mixer = new AnimationMixer(scene);
const samples = [[], ...singles(clips), ...blends(clips)];
const written = samples.map((sample) => positionsAt(sample));
requireRestored(written[0], positionsAt([]));
writeFileSync(out, Buffer.concat(written.map(littleEndian)));
const meshes = nodes.map(({ node, parts }) => ({ node, vertex_count: parts.reduce((sum, part) => sum + vertexCount(part), 0) }));
console.log(JSON.stringify({ samples: samples.map((clips) => ({ clips, meshes })), size: diagonal(written[0]) }));

// Rotations in a file are unit quaternions; where one is printed with three digits, three lets it stretch what it turns.
function makeUnit(clip) {
  for (const track of clip.tracks.filter((it) => it.ValueTypeName === 'quaternion')) {
    // Those with slopes among them three makes unit itself.
    if (track.values.length !== 4 * track.times.length) continue;
    for (let start = 0; start < track.values.length; start += 4) {
      const length = Math.hypot(...track.values.subarray(start, start + 4));
      for (let i = start; i < start + 4; i++) track.values[i] /= length;
    }
  }
}

// Every clip alone.
function singles(clips) {
  const moments = Array.from({ length: SAMPLES_PER_CLIP }, (_, i) => (i + 0.5) / SAMPLES_PER_CLIP);
  return clips.flatMap((_, index) => moments.map((moment) => [at(index, moment, 1)]));
}

// Neighbours in the file, at moments that are not the same part of both; each clip is in some of them.
function blends(clips) {
  const found = [];
  for (let first = 0; first + 1 < clips.length; first++) {
    for (const moment of [0.15, 0.6]) {
      const other = moment + 0.21;
      found.push([at(first, moment, 0.3), at(first + 1, other, 0.7)]);
      // Half of it is left to the rest pose.
      found.push([at(first, moment, 0.25), at(first + 1, other, 0.25)]);
    }
  }
  for (let first = 0; first + 2 < clips.length; first++) {
    // More than 1 in all, by which three divides.
    found.push([at(first, 0.35, 1), at(first + 1, 0.55, 1), at(first + 2, 0.8, 1)]);
  }
  return found;
}

function at(index, moment, weight) {
  return { index, time: moment * clips[index].duration, weight };
}

function positionsAt(sample) {
  for (const { index, time, weight } of sample) {
    const action = mixer.clipAction(clips[index]);
    action.reset();
    action.loop = LoopOnce;
    action.clampWhenFinished = true;
    action.setEffectiveWeight(weight).play();
    // Set and not stepped to: the sum of steps would be rounded.
    action.time = time;
  }
  mixer.update(0);
  scene.updateMatrixWorld(true);
  const positions = nodes.flatMap(({ parts }) => parts).map(worldPositions);
  // Puts every property back as it was before the first of these clips.
  mixer.stopAllAction();
  return joined(positions);
}

function worldPositions(mesh) {
  const positions = new Float32Array(3 * vertexCount(mesh));
  const position = new Vector3();
  for (let vertex = 0; 3 * vertex < positions.length; vertex++) {
    mesh.getVertexPosition(vertex, position);
    // A skinned mesh is bound to the world itself, see `load`.
    if (!mesh.isSkinnedMesh) mesh.localToWorld(position);
    position.toArray(positions, 3 * vertex);
  }
  return positions;
}

function vertexCount(mesh) {
  return mesh.geometry.attributes.position.count;
}

function joined(parts) {
  const whole = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
  let end = 0;
  for (const part of parts) {
    whole.set(part, end);
    end += part.length;
  }
  return whole;
}

function littleEndian(numbers) {
  const bytes = Buffer.alloc(4 * numbers.length);
  numbers.forEach((number, index) => {
    if (!Number.isFinite(number)) throw new Error(`number ${index} is ${number}`);
    bytes.writeFloatLE(number, 4 * index);
  });
  return bytes;
}

function diagonal(positions) {
  return new Box3().setFromArray(positions).getSize(new Vector3()).length();
}

function requireRestored(before, after) {
  if (before.some((number, index) => number !== after[index])) {
    throw new Error('the rest pose is another one after the animations');
  }
}

// The scene, its clips in the file's order, and the nodes that have a mesh with the primitives of each.
async function load(file) {
  const { json, buffers } = read(file);
  simplify(json);
  const glb = pack(json, buffers);
  const gltf = await new GLTFLoader().parseAsync(glb, '');
  const { associations } = gltf.parser;
  const nodes = [];
  gltf.scene.traverse((object) => {
    const node = associations.get(object)?.nodes;
    if (node === undefined || json.nodes[node].mesh === undefined) return;
    // A mesh of one primitive is the node; of several, they are the children that belong to no node.
    const candidates = object.isMesh ? [object] : object.children.filter((child) => associations.get(child)?.nodes === undefined);
    const parts = candidates.filter((part) => part.isMesh);
    if (parts.length !== candidates.length) console.error(`node ${node}: primitives other than triangles are left out`);
    parts.sort((a, b) => associations.get(a).primitives - associations.get(b).primitives);
    for (const part of parts) {
      // By default three takes the node's own transform off and puts it on again, which fails where it has no inverse.
      if (part.isSkinnedMesh) part.bindMode = DetachedBindMode;
    }
    nodes.push({ node, parts });
  });
  gltf.animations.forEach(makeUnit);
  return { scene: gltf.scene, clips: gltf.animations, nodes };
}

// Takes out what Node cannot load, and what three tells apart by name only.
function simplify(json) {
  for (const list of ['images', 'textures', 'samplers', 'materials', 'cameras']) delete json[list];
  json.meshes ??= [];
  const meshes = [];
  json.nodes?.forEach((node, index) => {
    delete node.camera;
    // three finds what a clip moves by its name, less some characters; the unnamed by an id of their own.
    node.name = `node_${index}`;
    if (node.mesh === undefined) return;
    // A mesh of its own for each node: three clones those of several, primitives' names included, and then moves only the first.
    const mesh = structuredClone(json.meshes[node.mesh]);
    delete mesh.name;
    for (const primitive of mesh.primitives) delete primitive.material;
    node.mesh = meshes.push(mesh) - 1;
  });
  json.meshes = meshes;
}

function read(file) {
  const bytes = readFileSync(file);
  const [json, embedded] = bytes.length >= 12 && bytes.readUInt32LE(0) === GLB_MAGIC ? chunks(bytes) : [bytes];
  const parsed = JSON.parse(json.toString('utf8'));
  const buffers = (parsed.buffers ?? []).map(({ uri, byteLength }, index) => {
    const content = uri === undefined && index === 0 ? embedded : resolved(uri, dirname(file));
    return content.subarray(0, byteLength);
  });
  return { json: parsed, buffers };
}

function chunks(bytes) {
  const found = new Map();
  for (let start = 12; start + 8 <= bytes.length; ) {
    const [length, kind] = [bytes.readUInt32LE(start), bytes.readUInt32LE(start + 4)];
    found.set(kind, bytes.subarray(start + 8, start + 8 + length));
    start += 8 + length;
  }
  return [found.get(CHUNK_JSON), found.get(CHUNK_BIN)];
}

function resolved(uri, folder) {
  if (!uri.startsWith('data:')) return readFileSync(join(folder, decodeURIComponent(uri)));
  const comma = uri.indexOf(',');
  const isBase64 = uri.slice(0, comma).endsWith(';base64');
  return isBase64 ? Buffer.from(uri.slice(comma + 1), 'base64') : Buffer.from(decodeURIComponent(uri.slice(comma + 1)), 'latin1');
}

// One GLB with one buffer: three would fetch any other, data URIs too, with classes that only browsers have.
function pack(json, buffers) {
  const starts = [];
  let length = 0;
  for (const buffer of buffers) {
    starts.push(length);
    // Views stay aligned for any type of component.
    length += Math.ceil(buffer.length / 8) * 8;
  }
  const binary = Buffer.alloc(length);
  buffers.forEach((buffer, index) => buffer.copy(binary, starts[index]));
  for (const view of json.bufferViews ?? []) {
    view.byteOffset = (view.byteOffset ?? 0) + starts[view.buffer];
    view.buffer = 0;
  }
  if (buffers.length > 0) json.buffers = [{ byteLength: length }];

  const bare = Buffer.from(JSON.stringify(json));
  const text = Buffer.concat([bare, Buffer.alloc((4 - (bare.length % 4)) % 4, ' ')]);
  const total = 12 + 8 + text.length + 8 + binary.length;
  const header = words(GLB_MAGIC, 2, total, text.length, CHUNK_JSON);
  const whole = Buffer.concat([header, text, words(binary.length, CHUNK_BIN), binary]);
  return whole.buffer.slice(whole.byteOffset, whole.byteOffset + whole.length);
}

function words(...numbers) {
  const bytes = Buffer.alloc(4 * numbers.length);
  numbers.forEach((number, index) => bytes.writeUInt32LE(number, 4 * index));
  return bytes;
}
