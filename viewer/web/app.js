// SPDX-License-Identifier: BSD-3-Clause
// The page: connection, view and panel put together. No library, no build step, nothing from the network.

import {Camera, moveByHand} from './camera.js';
import {LAYERS, drawRobot, drawRoomLabels} from './layers.js';
import {pick} from './pick.js';
import {$, makeLayerSwitches, updatePanel} from './panel.js';
import {darkQuery, readPalette} from './palette.js';
import {bounds, emptyState, judge, take, takeTile} from './state.js';

const canvas = $('map');
const ctx = canvas.getContext('2d');
const camera = new Camera();
let palette = readPalette();
let dirty = true;

// Also what the tests look at.
const page = window.modslam = {
  state: emptyState(), camera, connected: false, everConnected: false, paints: 0,
  visible: new Set(LAYERS.map((layer) => layer.name)),
  selected: null,
  select(selected) { page.selected = selected; refresh(); },
  judge: (name) => judge(page.state, page.state.processes.get(name), performance.now()),
};

function refresh() { dirty = true; updatePanel(page, performance.now()); }

function connect() {
  const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`);
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => { page.connected = page.everConnected = true; refresh(); };
  socket.onmessage = async ({data}) => {
    dirty = true;
    if (typeof data === 'string') return take(page.state, JSON.parse(data), performance.now());
    await takeTile(page.state, data);
    dirty = true;
  };
  socket.onclose = () => { page.connected = false; refresh(); setTimeout(connect, 700); };
}

function aim() {
  const box = camera.mode === 'fit' ? bounds(page.state) : null;
  if (box) camera.fit(box);
  if (camera.mode === 'robot' && page.state.pose) [camera.x, camera.y] = page.state.pose.pose;
}

function paint() {
  const ratio = window.devicePixelRatio || 1;
  const {clientWidth: width, clientHeight: height} = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  Object.assign(camera, {width, height});
  aim();
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.fillStyle = palette.unknown;
  ctx.fillRect(0, 0, width, height);
  const scene = {ctx, state: page.state, camera, palette, selected: page.selected};
  for (const layer of LAYERS) if (page.visible.has(layer.name)) layer.draw(scene);
  drawRobot(scene);
  if (page.visible.has('rooms')) drawRoomLabels(scene);
  drawScale();
  $('fit').setAttribute('aria-pressed', camera.mode === 'fit');
  $('follow').setAttribute('aria-pressed', camera.mode === 'robot');
  page.paints += 1;
}

function drawScale() {
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200];
  const metres = steps.find((m) => m * camera.scale >= 70) ?? 500;
  $('scale-bar').style.width = `${metres * camera.scale}px`;
  $('scale-text').textContent = `${metres} m`;
}

function frame() {
  if (dirty) { dirty = false; paint(); }
  requestAnimationFrame(frame);
}

function hover(px, py) {
  if (px === null) { $('cursor').textContent = ''; return; }
  const [x, y] = camera.toMap(px, py);
  $('cursor').textContent = `x ${x.toFixed(2)}  y ${y.toFixed(2)} m`;
  canvas.classList.toggle('over', pick(page.state, page.visible, camera.scale, x, y) !== null);
}

function setMode(mode) { camera.mode = camera.mode === mode ? 'free' : mode; dirty = true; }
function zoom(factor) { camera.zoom(factor); dirty = true; }
function togglePanel() { $('panel').classList.toggle('closed'); dirty = true; }

const KEYS = {
  '+': () => zoom(1.25), '=': () => zoom(1.25), '-': () => zoom(0.8),
  ArrowLeft: () => camera.pan(80, 0), ArrowRight: () => camera.pan(-80, 0),
  ArrowUp: () => camera.pan(0, 80), ArrowDown: () => camera.pan(0, -80),
  '0': () => setMode('fit'), f: () => setMode('robot'), p: togglePanel, Escape: () => page.select(null),
};
for (const layer of LAYERS) KEYS[layer.key] = () => $(`layer-${layer.name}`).click();

document.addEventListener('keydown', (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  const act = KEYS[e.key.length === 1 ? e.key.toLowerCase() : e.key];
  if (!act) return;
  e.preventDefault();
  act();
  dirty = true;
});

$('fit').onclick = () => setMode('fit');
$('follow').onclick = () => setMode('robot');
$('zoom-in').onclick = () => zoom(1.25);
$('zoom-out').onclick = () => zoom(0.8);
$('toggle-panel').onclick = togglePanel;
$('deselect').onclick = () => page.select(null);
moveByHand(canvas, camera, {
  click: (px, py) => page.select(pick(page.state, page.visible, camera.scale, ...camera.toMap(px, py))),
  hover, changed: () => { dirty = true; },
});
darkQuery.addEventListener('change', () => { palette = readPalette(); refresh(); });
new ResizeObserver(() => { dirty = true; }).observe(canvas);
if (window.innerWidth <= 760) $('panel').classList.add('closed');

makeLayerSwitches(page.visible, () => { dirty = true; });
setInterval(() => updatePanel(page, performance.now()), 250);
refresh();
connect();
requestAnimationFrame(frame);
