// SPDX-License-Identifier: BSD-3-Clause
// The page: connection, view, time line and panel put together. Nothing comes from the network but this viewer.

import {Backdrop} from './backdrop.js';
import {Camera, moveByHand} from './camera.js';
import {LAYERS, drawLastStep, drawMeasure, drawRobot, drawRoomLabels} from './layers.js';
import {readLayout, writeLayout} from './layout.js';
import {pick} from './pick.js';
import {Plots} from './plots.js';
import {$, makeLayerSwitches, updatePanel} from './panel.js';
import {darkQuery, readPalette, setTheme} from './palette.js';
import {bounds, emptyState, judge, take, takeTile} from './state.js';
import {Timeline} from './timeline.js';

const layout = readLayout(location.hash);
let theme = layout.theme;
setTheme(theme);

const canvas = $('map');
const ctx = canvas.getContext('2d');
const camera = new Camera();
const backdrop = new Backdrop();
const token = new URLSearchParams(location.search).get('token');
const query = token ? `token=${encodeURIComponent(token)}` : '';
let palette = readPalette(), palettes = 0;
let dirty = true;
let socket = null;

const live = emptyState();
// Also what the tests look at. `state` is what is shown: `live`, or a state of the past.
const page = window.modslam = {
  live, state: live, camera, connected: false, everConnected: false, paints: 0,
  visible: new Set(layout.layers ?? LAYERS.filter((layer) => !layer.off).map((layer) => layer.name)),
  selected: null, measure: null,
  select(selected) { page.selected = selected; refresh(); },
  judge: (name) => judge(live, live.processes.get(name), performance.now()),
  seek: (utime) => page.timeline.seek(utime),
  touch: () => { dirty = true; },  // paint again in the next frame
  shownUtime: () => page.timeline.utime ?? Infinity,
};
page.timeline = new Timeline(live, {query,
  show: (past) => { page.state = past ?? live; refresh(); },
  send: (words) => { if (socket?.readyState === WebSocket.OPEN) socket.send(words); }});
const plots = new Plots({seek: page.seek, cursor: () => page.timeline.utime});

function refresh() { dirty = true; updatePanel(page, performance.now()); }

function connect() {
  socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws${query ? `?${query}` : ''}`);
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => { page.connected = page.everConnected = true; refresh(); };
  socket.onmessage = async ({data}) => {
    dirty = true;
    if (typeof data !== 'string') { await takeTile(live, data); dirty = true; return; }
    const message = JSON.parse(data);
    take(live, message, performance.now());
    if (message.stream === 'hello') page.timeline.goLive();
    if (message.stream === 'series') plots.update(live.series);
  };
  socket.onclose = () => { page.connected = false; refresh(); setTimeout(connect, 700); };
}

function aim() {
  let box = camera.mode === 'fit' ? bounds(page.state) : null;
  if (box && page.state.pose) {
    const [x, y] = page.state.pose.pose;
    box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
  }
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
  const scene = {ctx, state: page.state, camera, palette, selected: page.selected, measure: page.measure};
  const key = [page.state.shape, palettes, [...page.visible].join(), page.selected?.kind, page.selected?.id].join('|');
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.fillStyle = palette.unknown;
  ctx.fillRect(0, 0, width, height);
  if (!backdrop.show(ctx, camera, ratio, key, (still) => paintStill({...scene, ctx: still}))) dirty = true;
  for (const layer of LAYERS) if (layer.moving && page.visible.has(layer.name)) layer.draw(scene);
  if (page.visible.has('path')) drawLastStep(scene);
  drawRobot(scene);
  drawMeasure(scene);
  drawScale();
  $('fit').setAttribute('aria-pressed', camera.mode === 'fit');
  $('follow').setAttribute('aria-pressed', camera.mode === 'robot');
  $('measure').setAttribute('aria-pressed', page.measure !== null);
  page.paints += 1;
}

function paintStill(scene) {
  scene.ctx.fillStyle = palette.unknown;
  scene.ctx.fillRect(0, 0, camera.width, camera.height);
  for (const layer of LAYERS) if (!layer.moving && page.visible.has(layer.name)) layer.draw(scene);
  if (page.visible.has('rooms')) drawRoomLabels(scene);
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

function click(px, py) {
  const point = camera.toMap(px, py), {measure} = page;
  if (!measure) return page.select(pick(page.state, page.visible, camera.scale, ...point));
  page.measure = measure.a && !measure.b ? {a: measure.a, b: point} : {a: point};
  dirty = true;
}

function setMode(mode) { camera.mode = camera.mode === mode ? 'free' : mode; dirty = true; }
function zoom(factor) { camera.zoom(factor); dirty = true; }
function togglePanel() { $('panel').classList.toggle('closed'); dirty = true; }
function toggleMeasure() { page.measure = page.measure ? null : {}; dirty = true; }
function letGo() { page.measure = null; page.select(null); }

function restyle() {
  setTheme(theme);
  palette = readPalette();
  palettes += 1;
  plots.restyle();
  plots.update(live.series);
  refresh();
}
function toggleTheme() { theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'; restyle(); }

const KEYS = {
  '+': () => zoom(1.25), '=': () => zoom(1.25), '-': () => zoom(0.8),
  ArrowLeft: () => camera.pan(80, 0), ArrowRight: () => camera.pan(-80, 0),
  ArrowUp: () => camera.pan(0, 80), ArrowDown: () => camera.pan(0, -80),
  '0': () => setMode('fit'), f: () => setMode('robot'), p: togglePanel, m: toggleMeasure, t: toggleTheme, Escape: letGo,
  ' ': () => page.timeline.toggle(), ',': () => page.timeline.step(-1), '.': () => page.timeline.step(1),
  l: () => page.timeline.goLive(), k: () => $('replay-play').click(), j: () => $('replay-step').click(),
};
for (const layer of LAYERS) KEYS[layer.key] = () => $(`layer-${layer.name}`).click();

document.addEventListener('keydown', (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  const act = KEYS[e.key.length === 1 ? e.key.toLowerCase() : e.key];
  const own = e.target.closest?.('select, input[type="range"]') ? ' ArrowLeftArrowRightArrowUpArrowDown' : e.target.closest?.('button, input') ? ' ' : '';
  if (!act || own.includes(e.key)) return;  // a focused control answers to its own keys
  e.preventDefault();
  act();
  dirty = true;
});

$('fit').onclick = () => setMode('fit');
$('follow').onclick = () => setMode('robot');
$('measure').onclick = toggleMeasure;
$('theme').onclick = toggleTheme;
$('zoom-in').onclick = () => zoom(1.25);
$('zoom-out').onclick = () => zoom(0.8);
$('toggle-panel').onclick = togglePanel;
$('deselect').onclick = () => page.select(null);
moveByHand(canvas, camera, {click, hover, changed: () => { dirty = true; }});
darkQuery.addEventListener('change', () => { if (!theme) restyle(); });
new ResizeObserver(() => { dirty = true; }).observe(canvas);
// The time line takes two rows on a narrow page.
new ResizeObserver(([entry]) => document.documentElement.style.setProperty('--timeline-height', `${entry.borderBoxSize[0].blockSize}px`)).observe($('timeline'));

camera.mode = layout.mode;
if (layout.camera) [camera.x, camera.y, camera.scale] = layout.camera;
if (layout.scale) camera.scale = layout.scale;
if (!(layout.panel ?? window.innerWidth > 760)) $('panel').classList.add('closed');

function keepLayout() {
  const hash = writeLayout({visible: page.visible, camera, panel: !$('panel').classList.contains('closed'), theme});
  if (hash !== location.hash) history.replaceState(null, '', hash);
}

makeLayerSwitches(page.visible, () => { dirty = true; });
setInterval(() => updatePanel(page, performance.now()), 250);
setInterval(keepLayout, 500);
setInterval(() => plots.update(live.series), 200);  // the line of the time that is shown
refresh();
connect();
requestAnimationFrame(frame);
