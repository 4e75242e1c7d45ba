// SPDX-License-Identifier: BSD-3-Clause
// One drawing function a layer, in the order of painting. Each gets {ctx, state, camera, palette, selected}.

import {drawContours} from './contours.js';
import {roomColor} from './palette.js';
import {middle} from './geometry.js';
import {drawTiles} from './tiles.js';

export const PLACE_KINDS = ['room', 'corridor', 'doorway'];

export const LAYERS = [
  {name: 'raster', label: 'Grid map', key: '1', color: 'occupied', draw: drawTiles},
  {name: 'rooms', label: 'Rooms', key: '2', color: 'accent', draw: drawRooms},
  {name: 'contours', label: 'Contours', key: 'c', color: 'contour', draw: drawContours, off: true},
  {name: 'objects', label: 'Objects', key: '3', color: 'object', draw: drawObjects},
  {name: 'walls', label: 'Walls', key: '4', color: 'wall', draw: drawWalls},
  {name: 'doors', label: 'Doors', key: '5', color: 'door-open', draw: drawDoors},
  {name: 'truth', label: 'True path', key: '6', color: 'truth', draw: drawTruth},
  {name: 'path', label: 'Path', key: '7', color: 'path', draw: drawPath},
  {name: 'graph', label: 'Pose graph', key: '8', color: 'loop', draw: drawGraph},
  {name: 'refused', label: 'Refused loops', key: 'r', color: 'refused', draw: drawProposals, off: true},
  {name: 'ellipses', label: 'Uncertainty', key: 'u', color: 'accent', draw: drawEllipses},
  {name: 'places', label: 'Kinds of place', key: 'o', color: 'corridor', draw: drawPlaces, off: true},
  {name: 'scan', label: 'Laser scan', key: '9', color: 'scan', draw: drawScan, moving: true},
];

function tracePolygon(ctx, camera, outline) {
  ctx.beginPath();
  for (let i = 0; i < outline.length; i += 2) ctx.lineTo(...camera.toScreen(outline[i], outline[i + 1]));
  ctx.closePath();
}

function isSelected(selected, kind, item) { return selected?.kind === kind && selected.id === item.id; }

// Whether an outline lies beside the window. Its box is found once.
function hidden(camera, item) {
  item.box ??= item.outline.reduce(([x0, y0, x1, y1], v, i) => i % 2 ? [x0, Math.min(y0, v), x1, Math.max(y1, v)]
    : [Math.min(x0, v), y0, Math.max(x1, v), y1], [Infinity, Infinity, -Infinity, -Infinity]);
  const [l, b] = camera.toScreen(item.box[0], item.box[1]), [r, t] = camera.toScreen(item.box[2], item.box[3]);
  return outside(camera, l, t, r, b);
}

function drawRooms({ctx, state, camera, selected}) {
  for (const room of state.rooms) {
    if (hidden(camera, room)) continue;
    const chosen = isSelected(selected, 'rooms', room);
    tracePolygon(ctx, camera, room.outline);
    ctx.fillStyle = roomColor(room.id, chosen ? 0.5 : 0.27);
    ctx.fill();
    ctx.strokeStyle = roomColor(room.id, chosen ? 1 : 0.7);
    ctx.lineWidth = chosen ? 3 : 1.2;
    ctx.stroke();
  }
}

export function roomName(room) {
  return room.name || `${room.type === 'corridor' ? 'Corridor' : 'Room'} ${room.id}`;
}

function text(ctx, palette, words, x, y) {
  ctx.lineWidth = 3;
  ctx.strokeStyle = palette.halo;
  ctx.strokeText(words, x, y);
  ctx.fillText(words, x, y);
}

function shortened(ctx, words, width) {
  let kept = words;
  while (kept.length > 1 && ctx.measureText(`${kept}…`).width > width) kept = kept.slice(0, -1);
  return kept === words ? words : `${kept}…`;
}

// Painted last, with layer rooms: a label under a wall cannot be read.
export function drawRoomLabels({ctx, state, camera, palette}) {
  ctx.textAlign = 'center';
  ctx.lineJoin = 'round';
  for (const room of state.rooms) {
    if (hidden(camera, room) || Math.min(room.box[2] - room.box[0], room.box[3] - room.box[1]) * camera.scale < 34) continue;
    room.middle ??= middle(room.outline);
    const [x, y] = camera.toScreen(room.middle.x, room.middle.y);
    const space = 2 * room.middle.room * camera.scale;
    if (space < 34) continue;
    ctx.fillStyle = palette.ink;
    ctx.font = '600 14px system-ui, "DejaVu Sans", sans-serif';
    const width = (room.box[2] - room.box[0]) * camera.scale;  // a name may leave a crooked room's own outline, not its box
    text(ctx, palette, shortened(ctx, roomName(room), Math.max(96, 1.4 * space, Math.min(140, 0.9 * width))), x, y - 2);
    ctx.fillStyle = palette.quiet;
    ctx.font = '12px system-ui, "DejaVu Sans", sans-serif';
    text(ctx, palette, `${room.area_m2.toFixed(1)} m²`, x, y + 14);
  }
}

function drawObjects({ctx, state, camera, palette, selected}) {
  ctx.font = '12px system-ui, "DejaVu Sans", sans-serif';
  ctx.textAlign = 'center';
  for (const object of state.objects) {
    tracePolygon(ctx, camera, object.outline);
    ctx.globalAlpha = isSelected(selected, 'objects', object) ? 0.7 : 0.35;
    ctx.fillStyle = palette.object;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.strokeStyle = palette.object;
    ctx.lineWidth = isSelected(selected, 'objects', object) ? 3 : 1.5;
    ctx.stroke();
    object.middle ??= middle(object.outline);
    const {x, y, room} = object.middle;
    if (!object.class || room * camera.scale < 10) continue;
    const [px, py] = camera.toScreen(x, y);
    ctx.fillStyle = palette.ink;
    text(ctx, palette, object.class, px, py + 4);
  }
}

function segment(ctx, camera, a, b) {
  ctx.beginPath();
  ctx.moveTo(...camera.toScreen(...a));
  ctx.lineTo(...camera.toScreen(...b));
  ctx.stroke();
}

function drawWalls({ctx, state, camera, palette, selected}) {
  ctx.lineCap = 'round';
  ctx.strokeStyle = palette.wall;
  ctx.lineWidth = Math.min(4, Math.max(2, camera.scale * 0.06));
  ctx.beginPath();
  for (const wall of state.walls) {
    ctx.moveTo(...camera.toScreen(...wall.a));
    ctx.lineTo(...camera.toScreen(...wall.b));
  }
  ctx.stroke();
  const chosen = state.walls.find((wall) => isSelected(selected, 'walls', wall));
  if (!chosen) return;
  ctx.strokeStyle = palette.accent;
  ctx.lineWidth = 6;
  segment(ctx, camera, chosen.a, chosen.b);
}

// A door is its opening from jamb to jamb; an open one swings its leaf, a closed one is shut by it.
function drawDoors({ctx, state, camera, palette, selected}) {
  ctx.lineCap = 'butt';
  for (const door of state.doors) {
    const chosen = isSelected(selected, 'doors', door);
    const color = palette[`door-${door.state}`];
    const [a, b] = [camera.toScreen(...door.a), camera.toScreen(...door.b)];
    const width = Math.min(8, Math.max(4, camera.scale * 0.1)) + (chosen ? 3 : 0);
    ctx.strokeStyle = palette.halo;
    ctx.lineWidth = width + 3;
    segment(ctx, camera, door.a, door.b);
    ctx.strokeStyle = color;
    ctx.lineWidth = width;
    if (door.state === 'open') ctx.setLineDash([width * 0.9, width * 0.7]);
    segment(ctx, camera, door.a, door.b);
    ctx.setLineDash([]);
    for (const jamb of [a, b]) {
      ctx.fillStyle = color;
      ctx.beginPath();
      ctx.arc(...jamb, width * 0.75, 0, 2 * Math.PI);
      ctx.fill();
    }
  }
}

const outside = ({width, height}, x0, y0, x1, y1) => x1 < 0 || y1 < 0 || x0 > width || y0 > height;

// Steps shorter than a pixel are left out: ten thousand poses cost what can be seen of them.
function trace(ctx, camera, poses) {
  ctx.beginPath();
  let pen = null, left = null;
  for (const pose of poses) {
    if (!pose) { pen = left = null; continue; }
    const p = camera.toScreen(pose[0], pose[1]);
    if (!pen) ctx.moveTo(...p);
    else if (Math.abs(p[0] - pen[0]) + Math.abs(p[1] - pen[1]) >= 1.2) ctx.lineTo(...p);
    else { left = p; continue; }
    pen = p;
    left = null;
  }
  if (left) ctx.lineTo(...left);
  ctx.stroke();
}

function drawTruth({ctx, state, camera, palette}) {
  ctx.strokeStyle = palette.truth;
  ctx.lineWidth = 1.6;
  ctx.setLineDash([6, 4]);
  trace(ctx, camera, state.truth);
  ctx.setLineDash([]);
}

function drawPath({ctx, state, camera, palette}) {
  ctx.strokeStyle = palette.path;
  ctx.lineWidth = 2;
  ctx.lineJoin = 'round';
  trace(ctx, camera, state.nodes);
}

// All pairs of nodes in one stroke; those that lie beside the window are left out.
function drawPairs(ctx, state, camera, pairs) {
  ctx.beginPath();
  for (const [from, to] of pairs) {
    const a = state.nodes[from], b = state.nodes[to];
    if (!a || !b) continue;
    const [ax, ay] = camera.toScreen(a[0], a[1]), [bx, by] = camera.toScreen(b[0], b[1]);
    if (outside(camera, Math.min(ax, bx), Math.min(ay, by), Math.max(ax, bx), Math.max(ay, by))) continue;
    ctx.moveTo(ax, ay);
    ctx.lineTo(bx, by);
  }
  ctx.stroke();
}

function drawGraph({ctx, state, camera, palette, selected}) {
  const size = Math.min(3, Math.max(1, camera.scale * 0.03));
  let last = [-9, -9];
  ctx.fillStyle = palette.node;
  ctx.beginPath();
  for (const node of state.nodes) {
    if (!node) continue;
    const [x, y] = camera.toScreen(node[0], node[1]);
    if (Math.abs(x - last[0]) + Math.abs(y - last[1]) < 2 || outside(camera, x, y, x, y)) continue;
    ctx.rect(x - size, y - size, 2 * size, 2 * size);
    last = [x, y];
  }
  ctx.fill();
  ctx.lineWidth = 2;
  ctx.strokeStyle = palette.retracted;
  ctx.setLineDash([2, 4]);
  drawPairs(ctx, state, camera, state.retracted);
  ctx.setLineDash([]);
  ctx.strokeStyle = palette.loop;
  drawPairs(ctx, state, camera, state.edges);
  drawChosen({ctx, state, camera, palette, selected});
}

function drawChosen({ctx, state, camera, palette, selected}) {
  const node = selected?.kind === 'nodes' ? state.nodes[selected.id] : null;
  ctx.strokeStyle = palette.accent;
  ctx.lineWidth = 4;
  if (selected?.kind === 'loops') drawPairs(ctx, state, camera, [String(selected.id).split('-').map(Number)]);
  if (!node) return;
  ctx.beginPath();
  ctx.arc(...camera.toScreen(node[0], node[1]), 7, 0, 2 * Math.PI);
  ctx.stroke();
}

// A dot a node in the colour of its kind, fainter where it is less sure.
function drawPlaces({ctx, state, camera, palette}) {
  const size = Math.min(9, Math.max(3, camera.scale * 0.09));
  let last = [-9, -9];
  state.nodes.forEach((node, i) => {
    const kind = PLACE_KINDS[state.places[2 * i]];
    if (!node || !kind) return;
    const [x, y] = camera.toScreen(node[0], node[1]);
    if (Math.abs(x - last[0]) + Math.abs(y - last[1]) < 2 || outside(camera, x, y, x, y)) return;
    last = [x, y];
    ctx.globalAlpha = Math.max(0.3, (state.places[2 * i + 1] - 30) / 70);
    ctx.fillStyle = palette[kind];
    ctx.fillRect(x - size / 2, y - size / 2, size, size);
  });
  ctx.globalAlpha = 1;
}

// What the loop detector proposed and the graph has not taken: refused by its own verdict thin, by the graph dashed.
function drawProposals({ctx, state, camera, palette}) {
  const pairs = (refused) => openProposals(state).filter((p) => p.refused === refused).map((p) => [p.from, p.to]);
  ctx.strokeStyle = palette.refused;
  ctx.lineWidth = 1;
  drawPairs(ctx, state, camera, pairs(true));
  ctx.strokeStyle = palette.loop;
  ctx.lineWidth = 1.5;
  ctx.setLineDash([5, 4]);
  drawPairs(ctx, state, camera, pairs(false));
  ctx.setLineDash([]);
}

export function openProposals(state) {
  if (state.openShape === state.shape) return state.open;
  const accepted = new Set(state.edges.map(([from, to]) => `${from}-${to}`));
  state.openShape = state.shape;
  state.open = state.proposals.filter((p) => !accepted.has(`${p.from}-${p.to}`) && !accepted.has(`${p.to}-${p.from}`));
  return state.open;
}

const SIGMAS_95 = Math.sqrt(5.991);  // a plane normal lies within with 95 percent

// One ellipse where there is room for it.
function drawEllipses({ctx, state, camera, palette}) {
  let last = [-99, -99];
  ctx.strokeStyle = palette.accent;
  ctx.globalAlpha = 0.55;
  ctx.lineWidth = 1;
  ctx.beginPath();
  state.ellipses.forEach((ellipse, i) => {
    const node = state.nodes[i];
    if (!node || !ellipse || !(ellipse[0] > 0)) return;
    const [x, y] = camera.toScreen(node[0], node[1]);
    const [long, short] = [ellipse[0], ellipse[1]].map((s) => s * SIGMAS_95 * camera.scale);
    if (long < 1.5 || long > 1e4 || Math.hypot(x - last[0], y - last[1]) < Math.max(12, 0.7 * long)) return;
    if (outside(camera, x - long, y - long, x + long, y + long)) return;
    last = [x, y];
    ctx.moveTo(x + long * Math.cos(ellipse[2]), y - long * Math.sin(ellipse[2]));
    ctx.ellipse(x, y, long, short, -ellipse[2], 0, 2 * Math.PI);
  });
  ctx.stroke();
  ctx.globalAlpha = 1;
}

function drawScan({ctx, state, camera, palette}) {
  const points = state.scan?.points ?? [];
  const size = Math.min(5, Math.max(2, camera.scale * 0.045));
  ctx.fillStyle = palette.scan;
  for (let i = 0; i < points.length; i += 2) {
    const [x, y] = camera.toScreen(points[i], points[i + 1]);
    ctx.fillRect(x - size / 2, y - size / 2, size, size);
  }
}

// The way from the newest node to the robot, which moves with it.
export function drawLastStep({ctx, state, camera, palette}) {
  const node = state.nodes.at(-1);
  if (!node || !state.pose) return;
  ctx.strokeStyle = palette.path;
  ctx.lineWidth = 2;
  segment(ctx, camera, node.slice(0, 2), state.pose.pose.slice(0, 2));
}

export function drawMeasure({ctx, camera, palette, measure}) {
  if (!measure?.a) return;
  const {a, b} = measure;
  ctx.strokeStyle = ctx.fillStyle = palette.ink;
  ctx.lineWidth = 1.5;
  for (const p of [a, b]) if (p) { ctx.beginPath(); ctx.arc(...camera.toScreen(...p), 3.5, 0, 2 * Math.PI); ctx.fill(); }
  if (!b) return;
  segment(ctx, camera, a, b);
  const [x, y] = camera.toScreen((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
  ctx.textAlign = 'center';
  ctx.font = '600 14px system-ui, "DejaVu Sans", sans-serif';
  text(ctx, palette, `${Math.hypot(b[0] - a[0], b[1] - a[1]).toFixed(2)} m`, x, y - 8);
}

// Always painted: the robot, and the ellipse that holds it with 95 percent.
export function drawRobot({ctx, state, camera, palette}) {
  if (!state.pose && !state.scan) return;
  const [x, y, heading] = state.pose?.pose ?? [0, 0, 0];
  const [px, py] = camera.toScreen(x, y);
  if (state.pose) drawEllipse(ctx, camera, palette, px, py, state.pose.covariance_xy);
  const r = Math.min(16, Math.max(8, camera.scale * 0.25));
  ctx.save();
  ctx.translate(px, py);
  ctx.rotate(-heading);
  ctx.beginPath();
  ctx.moveTo(r * 1.15, 0); ctx.lineTo(-r * 0.8, r * 0.75); ctx.lineTo(-r * 0.45, 0); ctx.lineTo(-r * 0.8, -r * 0.75);
  ctx.closePath();
  ctx.fillStyle = palette.robot;
  ctx.strokeStyle = palette.halo;
  ctx.lineWidth = 2;
  ctx.stroke();
  ctx.fill();
  ctx.restore();
}

function drawEllipse(ctx, camera, palette, px, py, [xx, xy, yy]) {
  const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
  const radius = (variance) => Math.sqrt(5.991 * Math.max(0, variance)) * camera.scale;
  const [long, short] = [radius(mean + spread), radius(mean - spread)];
  if (!(long > 2 && long < 1e5)) return;
  ctx.beginPath();
  ctx.ellipse(px, py, long, short, -0.5 * Math.atan2(2 * xy, xx - yy), 0, 2 * Math.PI);
  ctx.strokeStyle = palette.accent;
  ctx.lineWidth = 1.5;
  ctx.stroke();
}
