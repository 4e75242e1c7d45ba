// SPDX-License-Identifier: BSD-3-Clause
// What the page knows of the run: one field a stream. README.md has the format of the messages.

const TILE_HEADER = 24;

export function emptyState() {
  return {
    version: '', pose: null, scan: null, edges: [], clock: null, clockAt: 0, clocks: [],
    nodes: [], truth: [],           // [x, y, heading]
    walls: [], rooms: [], doors: [], objects: [],
    tiles: new Map(),               // 'x/y' -> {x, y, ncells, resolution, version, cells}
    processes: new Map(),           // name -> status
    changes: 0,                     // counts everything that was taken in
  };
}

// Takes one JSON message in. `now` is this page's own clock [ms].
export function take(state, message, now) {
  state.changes += 1;
  switch (message.stream) {
    case 'hello': Object.assign(state, emptyState(), {version: message.version}); break;
    case 'pose': state.pose = message; break;
    case 'scan': state.scan = message; break;
    case 'edges': state.edges = message.loops; break;
    case 'nodes': takePoses(state.nodes, message); break;
    case 'truth': takePoses(state.truth, message); break;
    case 'walls': case 'rooms': case 'doors': case 'objects': state[message.stream] = message.items; break;
    case 'status': state.processes.set(message.name, message); break;
    case 'clock':
      state.clock = message;
      state.clockAt = now;
      state.clocks = [...state.clocks, message].slice(-7);
      break;
  }
}

// Pieces may overtake each other: a hole stays empty until its piece is here.
function takePoses(list, {first, poses}) {
  for (let i = 0; i * 3 < poses.length; i++) list[first + i] = [poses[3 * i], poses[3 * i + 1], poses[3 * i + 2]];
}

// Takes one binary message in: a tile. Unpacking takes a while, so a newer one may come first.
export async function takeTile(state, buffer) {
  const view = new DataView(buffer);
  const tile = {
    x: view.getInt32(0, true), y: view.getInt32(4, true), ncells: view.getInt32(8, true),
    version: view.getInt32(12, true), resolution: view.getFloat64(16, true), cells: null,
  };
  const key = `${tile.x}/${tile.y}`;
  const tiles = state.tiles;  // a hello replaces the map; then this tile belongs to the old one
  tiles.set(key, Object.assign(tile, {cells: tiles.get(key)?.cells ?? null, pending: true}));
  const packed = new Blob([new Uint8Array(buffer, TILE_HEADER)]);
  const unpacked = packed.stream().pipeThrough(new DecompressionStream('deflate'));
  const cells = new Uint8Array(await new Response(unpacked).arrayBuffer());
  if (tiles.get(key) !== tile) return;
  tile.cells = cells;
  tile.pending = false;
  state.changes += 1;
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
