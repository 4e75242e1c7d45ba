// SPDX-License-Identifier: BSD-3-Clause
// What the page knows of the run: one field a stream. README.md has the format of the messages.

const TILE_HEADER = 24, MAX_UNPACKED = 4000, PIECE = 256;  // as trail.hpp cuts
const MOVING = new Set(['pose', 'scan', 'status', 'clock', 'series', 'events', 'playback']);
let shapes = 0;  // counts what changes the picture behind the robot, over all states

export function emptyState() {
  return {
    shape: ++shapes,
    version: '', pose: null, scan: null, edges: [], retracted: [], proposals: [], clock: null, clockAt: 0, clocks: [],
    nodes: [], truth: [],           // [x, y, heading]
    ellipses: [],                   // of the nodes: half axes and heading at one sigma
    events: [], series: null, playback: null,
    walls: [], rooms: [], doors: [], objects: [],
    places: [],                     // of the nodes, flat: kind (0 room, 1 corridor, 2 doorway) and confidence in per cent
    tiles: new Map(),               // 'x/y' -> {x, y, ncells, resolution, version, cells}
    processes: new Map(),           // name -> status
    changes: 0,                     // counts everything that was taken in
  };
}

// Takes one JSON message in. `now` is this page's own clock [ms].
export function take(state, message, now) {
  state.changes += 1;
  if (!MOVING.has(message.stream)) state.shape = ++shapes;
  switch (message.stream) {
    case 'hello': Object.assign(state, emptyState(), {version: message.version}); break;
    case 'pose': state.pose = message; break;
    case 'scan': state.scan = message; break;
    case 'edges': state.edges = message.loops; state.retracted = message.retracted; break;
    case 'proposals': state.proposals = rowsOf(message, ['from', 'to', 'verdict', 'refused', 'score', 'overlap', 'innovation']); break;
    case 'events': state.events = message.items; break;
    case 'series': case 'playback': state[message.stream] = message; break;
    case 'ellipses': takePoses(state.ellipses, message); break;
    case 'nodes': takePoses(state.nodes, message); break;
    case 'truth': takePoses(state.truth, message); break;
    case 'walls': case 'rooms': case 'doors': case 'objects': case 'places': state[message.stream] = message.items; break;
    case 'status': state.processes.set(message.name, message); break;
    case 'clock':
      state.clock = message;
      state.clockAt = now;
      state.clocks = [...state.clocks, message].slice(-7);
      break;
  }
}

// Objects from columns of the same length.
function rowsOf(columns, names) {
  return columns[names[0]].map((_, k) => Object.fromEntries(names.map((name) => [name, columns[name][k]])));
}

// Pieces may overtake each other: a hole stays empty until its piece is here. One that is not full is the last.
function takePoses(list, {first, poses}) {
  for (let i = 0; i * 3 < poses.length; i++) list[first + i] = [poses[3 * i], poses[3 * i + 1], poses[3 * i + 2]];
  if (poses.length < 3 * PIECE) list.length = first + poses.length / 3;
}

const unpacked = new Map();  // 'x/y/version/bytes' -> cells: the past asks for the same tiles again and again

async function unpack(key, packed) {
  const known = unpacked.get(key);
  if (known) return known;
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const cells = new Uint8Array(await new Response(stream).arrayBuffer());
  if (unpacked.size >= MAX_UNPACKED) unpacked.clear();
  unpacked.set(key, cells);
  return cells;
}

// Takes one binary message in: a tile. Unpacking takes a while, so a newer one may come first.
export async function takeTile(state, buffer, at = 0, size = buffer.byteLength) {
  const view = new DataView(buffer, at, size);
  const tile = {
    x: view.getInt32(0, true), y: view.getInt32(4, true), ncells: view.getInt32(8, true),
    version: view.getInt32(12, true), resolution: view.getFloat64(16, true), cells: null,
  };
  const key = `${tile.x}/${tile.y}`;
  const tiles = state.tiles;  // a hello replaces the map; then this tile belongs to the old one
  tiles.set(key, Object.assign(tile, {cells: tiles.get(key)?.cells ?? null, pending: true}));
  const packed = new Uint8Array(buffer, at + TILE_HEADER, size - TILE_HEADER);
  const sum = packed.subarray(-4).join('.');  // zlib's own checksum tells versions of two sessions apart
  const cells = await unpack(`${key}/${tile.version}/${size}/${sum}`, packed);
  if (tiles.get(key) !== tile) return;
  tile.cells = cells;
  tile.pending = false;
  state.changes += 1;
  state.shape = ++shapes;
}

// The state that an answer of /past describes: frames, each behind a byte (1: binary) and its length.
export async function readPast(buffer) {
  const state = emptyState(), view = new DataView(buffer), words = new TextDecoder(), tiles = [];
  for (let at = 0; at < buffer.byteLength;) {
    const binary = view.getUint8(at) === 1, size = view.getUint32(at + 1, true);
    at += 5;
    if (binary) tiles.push(takeTile(state, buffer, at, size));
    else take(state, JSON.parse(words.decode(new Uint8Array(buffer, at, size))), 0);
    at += size;
  }
  await Promise.all(tiles);
  return state;
}

// How long a process has been silent [ms], by the viewer's clock as this page last heard it.
export function silence(state, status, now) {
  return state.clock ? Math.max(0, state.clock.now_ms - status.seen_ms + (now - state.clockAt)) : 0;
}

// One word and a class for a process: good, done, bad or off.
export function judge(state, status, now) {
  const silent = silence(state, status, now);
  if (status.state === 'stopped') return ['stopped', 'off'];
  if (silent > 3000) return [`silent ${Math.floor(silent / 1000)} s`, 'bad'];
  if (status.state === 'running') return ['running', 'good'];
  if (status.state === 'finished') return ['finished', 'done'];
  return [status.state, 'bad'];
}

// Messages a second of each channel over the last three seconds.
export function rates(state) {
  const [first, last] = [state.clocks[0], state.clocks.at(-1)];
  const seconds = first ? (last.now_ms - first.now_ms) / 1000 : 0;
  const before = new Map((first?.channels ?? []).map((c) => [c.channel, c.received]));
  return new Map((last?.channels ?? []).map(
    (c) => [c.channel, seconds > 0 ? (c.received - (before.get(c.channel) ?? 0)) / seconds : 0]));
}

// [x0, y0, x1, y1] of all that is known, or null.
export function bounds(state) {
  if (state.boxShape !== state.shape) { state.boxShape = state.shape; state.box = measure(state); }
  return state.box;
}

function measure(state) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const add = (x, y) => {
    box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y);
    box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
  };
  for (const p of state.nodes) if (p) add(p[0], p[1]);
  for (const w of state.walls) { add(...w.a); add(...w.b); }
  for (const r of state.rooms) for (let i = 0; i < r.outline.length; i += 2) add(r.outline[i], r.outline[i + 1]);
  if (state.pose) add(state.pose.pose[0], state.pose.pose[1]);
  if (box[0] > box[2] || state.rooms.length + state.walls.length === 0) {
    for (const t of state.tiles.values()) {
      const side = t.ncells * t.resolution;
      add(t.x * side, t.y * side); add((t.x + 1) * side, (t.y + 1) * side);
    }
    const points = state.scan?.points ?? [];
    for (let i = 0; i < points.length; i += 2) add(points[i], points[i + 1]);
  }
  return box[0] <= box[2] ? box : null;
}
