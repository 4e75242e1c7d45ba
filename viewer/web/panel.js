// SPDX-License-Identifier: BSD-3-Clause
// The panel. Everything that came in a message is shown as text, never as markup.

import {LAYERS, roomName} from './layers.js';
import {describe, find} from './pick.js';
import {roomColor} from './palette.js';
import {judge, rates} from './state.js';

export const $ = (id) => document.getElementById(id);

export function element(tag, className = '', ...children) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.append(...children);
  return made;
}

// Writes only what differs: a page that stands still costs nothing and a click hits what it aimed at.
function say(node, words) {
  const text = String(words);
  if (node.textContent !== text) node.textContent = text;
}

// One child of `parent` for each item, kept by key and in order.
function keep(parent, items, key, make, update) {
  const known = (parent.known ??= new Map());
  const wanted = new Set(items.map(key));
  for (const [k, node] of known) if (!wanted.has(k)) { node.remove(); known.delete(k); }
  items.forEach((item, i) => {
    let node = known.get(key(item));
    if (!node) known.set(key(item), (node = make(item)));
    if (parent.children[i] !== node) parent.insertBefore(node, parent.children[i] ?? null);
    update(node, item);
  });
}

export function makeLayerSwitches(visible, changed) {
  for (const layer of LAYERS) {
    const box = element('input');
    box.type = 'checkbox';
    box.id = `layer-${layer.name}`;
    box.checked = visible.has(layer.name);
    box.addEventListener('change', () => {
      if (box.checked) visible.add(layer.name); else visible.delete(layer.name);
      changed();
    });
    const swatch = element('i');
    swatch.style.background = `var(--${layer.color})`;
    $('layers').append(element('label', '', box, swatch, layer.label, element('kbd', '', layer.key)));
  }
}

export function updatePanel(page, now) {
  const {state} = page;
  say($('link'), page.connected ? `live · ${page.live.version}` : 'no connection');
  $('link').classList.toggle('off', !page.connected);
  $('banner').hidden = page.connected;
  say($('banner'), page.everConnected ? 'The viewer is gone. Waiting for it …' : 'Connecting to the viewer …');
  updateSelection(page);
  updateRooms(page);
  updateProcesses(page, now);
  updateRun({...state, clock: page.live.clock});
  updateChannels(page.live);
  updateEvents(page);
}

function fields(list, rows) {
  keep(list, rows.flatMap(([name, value]) => [['dt', name, name], ['dd', name, value]]), ([tag, name]) => tag + name,
    ([tag]) => element(tag), (node, [, , words]) => say(node, words));
}

function updateSelection(page) {
  const item = find(page.state, page.selected);
  $('selection').hidden = !item;
  if (!item) return;
  const [title, rows] = describe(page.state, page.selected, item);
  say($('selection-title'), title);
  fields($('selection-fields'), rows);
}

function updateRooms(page) {
  const rooms = [...page.state.rooms].sort((a, b) => b.area_m2 - a.area_m2);
  $('rooms-none').hidden = rooms.length > 0;
  const total = rooms.reduce((sum, r) => sum + r.area_m2, 0);
  say($('rooms-total'), rooms.length ? `${rooms.length}, ${total.toFixed(1)} m²` : '');
  keep($('rooms'), rooms, (r) => r.id, (room) => {
    const button = element('button', '', element('span', 'swatch'), element('span', 'name'), element('span', 'area quiet'));
    button.addEventListener('click', () => page.select({kind: 'rooms', id: room.id}));
    return element('li', '', button);
  }, (node, room) => {
    const button = node.firstChild, [swatch, name, area] = button.children;
    swatch.style.background = roomColor(room.id, 0.8);
    say(name, roomName(room));
    say(area, `${room.area_m2.toFixed(1)} m²`);
    button.title = `${roomName(room)}: ${room.type}, explored ${Math.round(100 * room.explored)} %`;
    button.setAttribute('aria-pressed', page.selected?.kind === 'rooms' && page.selected.id === room.id);
  });
}

function updateProcesses({live: state, connected}, now) {
  const list = [...state.processes.values()].sort((a, b) => a.name.localeCompare(b.name));
  $('processes-none').hidden = list.length > 0;
  $('processes').classList.toggle('stale', !connected);
  const ill = list.filter((p) => judge(state, p, now)[1] === 'bad').length;
  say($('processes-total'), ill ? `${ill} of ${list.length} in trouble` : list.length ? `all ${list.length} well` : '');
  $('processes-total').classList.toggle('alarm', ill > 0);
  keep($('processes'), list, (p) => p.name, (process) => {
    const row = element('li', '', element('span', 'dot'), element('span', 'name'), element('span', 'state'), element('span', 'words'));
    row.dataset.process = process.name;
    return row;
  }, (row, process) => {
    const [word, judgement] = judge(state, process, now);
    const [, name, shown, words] = row.children;
    if (row.className !== judgement) row.className = judgement;
    say(name, process.name);
    say(shown, word);
    say(words, process.words);
    row.title = `version ${process.version}, pid ${process.pid}, ${Math.round(process.memory_kb / 1024)} MB, ` +
      `handlers ${(process.latency_p50_us / 1000).toFixed(1)} ms (99 %: ${(process.latency_p99_us / 1000).toFixed(1)} ms)`;
  });
}

function updateRun({clock, pose, nodes, edges}) {
  const sigma = pose ? Math.sqrt(Math.max(0, pose.covariance_xy[0] + pose.covariance_xy[2])) : 0;
  fields($('run'), [
    ['pose', pose ? `${pose.pose[0].toFixed(2)}, ${pose.pose[1].toFixed(2)} m, ${(pose.pose[2] * 180 / Math.PI).toFixed(0)}°` : '–'],
    ['uncertainty', pose ? `${(sigma * 100).toFixed(1)} cm` : '–'],
    ['nodes', clock ? `${nodes.length}${clock.complete ? '' : ' (catching up)'}` : '–'],
    ['error', pose?.error_m === undefined ? '–' : `${(pose.error_m * 100).toFixed(1)} cm`],
    ['loops in the graph', edges.length],
    ['loops proposed', clock ? clock.loops_proposed : '–'],
    ['loops refused', clock ? clock.loops_refused : '–'],
  ]);
}

const EVENTS_SHOWN = 60;

function updateEvents({live, seek, shownUtime}) {
  const begin = live.clock?.past[0] ?? 0, now = shownUtime();
  const shown = live.events.filter(([utime]) => utime <= now).slice(-EVENTS_SHOWN).reverse();
  $('events-none').hidden = shown.length > 0;
  keep($('events'), shown, (e) => e.join('|'), ([utime, kind]) => {
    const button = element('button', '', element('span', 'at'), element('span', kind));
    button.title = 'Show the run at this time';
    button.addEventListener('click', () => seek(utime));
    return element('li', '', button);
  }, (row, [utime, , words]) => {
    const [at, said] = row.firstChild.children;
    say(at, `${((utime - begin) / 1e6).toFixed(1)} s`);
    say(said, words);
  });
}

function updateChannels(state) {
  const perSecond = rates(state);
  const rows = (state.clock?.channels ?? []).filter((c) => c.received + c.bad + c.gaps > 0 && c.channel !== 'COMMAND');
  keep($('channels'), rows, (c) => c.channel, () => element('tr', '', ...[...Array(5)].map(() => element('td'))), (row, c) => {
    const cells = [c.channel, perSecond.get(c.channel).toFixed(1), c.received, c.gaps || '', c.bad || ''];
    cells.forEach((words, i) => say(row.children[i], words));
    row.children[3].className = c.gaps ? 'alarm' : '';
    row.children[4].className = c.bad ? 'alarm' : '';
  });
}
