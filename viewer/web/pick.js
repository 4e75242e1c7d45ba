// SPDX-License-Identifier: BSD-3-Clause
// What lies under a click, and what to say of it.

import {inside, toSegment} from './geometry.js';
import {openProposals, roomName} from './layers.js';

const REACH_PX = 9;

// @return {kind, id} of the topmost visible thing at map point (x, y), or null.
export function pick(state, visible, scale, x, y) {
  const reach = REACH_PX / scale;
  const nearest = (items) => {
    let best = null, least = reach;
    for (const item of items) {
      const d = toSegment(x, y, item.a, item.b);
      if (d <= least) [best, least] = [item, d];
    }
    return best;
  };
  const within = (items) => items.find((item) => inside(item.outline, x, y));
  const order = [['doors', () => nearest(state.doors), 'doors'], ['objects', () => within(state.objects), 'objects'],
    ['nodes', () => nearestNode(state, x, y, reach * 0.8), 'graph'], ['loops', () => nearest(lines(state, visible)), 'loops'],
    ['walls', () => nearest(state.walls), 'walls'], ['rooms', () => within(state.rooms), 'rooms']];
  for (const [kind, find, layer] of order) {
    const item = kind === 'loops' || visible.has(layer) ? find() : null;
    if (item) return {kind, id: item.id};
  }
  return null;
}

function nearestNode(state, x, y, reach) {
  let best = null, least = reach;
  state.nodes.forEach((node, id) => {
    const d = Math.hypot(node[0] - x, node[1] - y);
    if (d <= least) [best, least] = [{id}, d];
  });
  return best;
}

// The loops that are drawn, as segments.
function lines(state, visible) {
  const pairs = [...(visible.has('graph') ? [...state.edges, ...state.retracted] : []),
    ...(visible.has('refused') ? openProposals(state).map((p) => [p.from, p.to]) : [])];
  return pairs.filter(([from, to]) => state.nodes[from] && state.nodes[to])
    .map(([from, to]) => ({id: `${from}-${to}`, a: state.nodes[from], b: state.nodes[to]}));
}

export function find(state, selected) {
  if (!selected) return undefined;
  if (selected.kind === 'nodes') return state.nodes[selected.id];
  if (selected.kind === 'loops') return selected.id.split('-').every((id) => state.nodes[id]) ? selected : undefined;
  return state[selected.kind].find((item) => item.id === selected.id);
}

function describeLoop(state, id) {
  const [from, to] = id.split('-').map(Number), is = ([a, b]) => a === from && b === to;
  const proposal = state.proposals.findLast((p) => is([p.from, p.to]) || is([p.to, p.from]));
  const fate = state.edges.some(is) ? 'accepted' : state.retracted.some(is) ? 'taken back' : proposal?.refused ? 'refused' : 'proposed';
  const [a, b] = [state.nodes[from], state.nodes[to]];
  const rows = [['state', fate], ['nodes', `${from} and ${to}`], ['apart', metres(Math.hypot(a[0] - b[0], a[1] - b[1]))]];
  if (proposal) rows.push(['verdict', proposal.verdict], ['score', proposal.score.toFixed(2)], ['overlap', percent(proposal.overlap)],
    ['innovation', proposal.innovation.toFixed(1)]);
  return [`Loop ${from} – ${to}`, rows];
}

function describeNode(state, id, node) {
  const rows = [['position', place(node)], ['heading', `${(node[2] * 180 / Math.PI).toFixed(1)}°`]];
  const ellipse = state.ellipses[id];
  if (ellipse?.[0] > 0) rows.push(['sigma when new', `${(100 * ellipse[0]).toFixed(1)} × ${(100 * ellipse[1]).toFixed(1)} cm`]);
  rows.push(['loops', state.edges.filter(([a, b]) => a === id || b === id).length]);
  return [`Node ${id}`, rows];
}

const metres = (v) => `${v.toFixed(2)} m`;
const area = (v) => `${v.toFixed(1)} m²`;
const percent = (v) => `${Math.round(100 * v)} %`;
const place = ([x, y]) => `${x.toFixed(2)}, ${y.toFixed(2)}`;

const end = (p, known) => !known ? place(p) : known.seen ? `${place(p)} ± ${known.along_m.toFixed(2)} m` : `${place(p)}, what follows was not seen`;

// @return [title, [[name, value], ...]]
export function describe(state, {kind, id}, item) {
  const room = (rid) => {
    const known = state.rooms.find((r) => r.id === rid);
    return known ? roomName(known) : rid === 0 ? 'not known' : `${rid}`;
  };
  switch (kind) {
    case 'nodes': return describeNode(state, id, item);
    case 'loops': return describeLoop(state, id);
    case 'rooms': return [roomName(item), [['type', item.type], ['area', area(item.area_m2)],
      ['explored', percent(item.explored)], ['evidence', item.evidence.toFixed(2)], ['corners', item.outline.length / 2], ['id', id]]];
    case 'doors': return [`Door ${id}`, [['state', item.state], ['width', metres(item.width_m)],
      ['between', item.rooms.map(room).join(' and ')], ['evidence', item.evidence.toFixed(2)], ['id', id]]];
    case 'walls': return [`Wall ${id}`, [['length', metres(item.length_m)], ['evidence', item.evidence.toFixed(2)],
      ['spread', `${(item.sigma_m * 1000).toFixed(0)} mm`], ['from', end(item.a, item.ends?.[0])], ['to', end(item.b, item.ends?.[1])], ['id', id]]];
    default: return [item.class || `Object ${id}`, [['class', item.class ? `${item.class}, ${percent(item.class_confidence ?? 0)}` : 'not known'], ['area', `${item.area_m2.toFixed(2)} m²`],
      ['seen for', `${((item.last_utime - item.first_utime) / 1e6).toFixed(1)} s`], ['evidence', item.evidence.toFixed(2)], ['id', id]]];
  }
}
