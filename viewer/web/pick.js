// SPDX-License-Identifier: BSD-3-Clause
// What lies under a click, and what to say of it.

import {inside, toSegment} from './geometry.js';
import {roomName} from './layers.js';

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
  const order = [['doors', nearest], ['objects', within], ['walls', nearest], ['rooms', within]];
  for (const [kind, find] of order) {
    const item = visible.has(kind) ? find(state[kind]) : null;
    if (item) return {kind, id: item.id};
  }
  return null;
}

export function find(state, selected) {
  return selected ? state[selected.kind].find((item) => item.id === selected.id) : undefined;
}

const metres = (v) => `${v.toFixed(2)} m`;
const area = (v) => `${v.toFixed(1)} m²`;
const percent = (v) => `${Math.round(100 * v)} %`;
const place = ([x, y]) => `${x.toFixed(2)}, ${y.toFixed(2)}`;

// @return [title, [[name, value], ...]]
export function describe(state, {kind, id}, item) {
  const room = (rid) => {
    const known = state.rooms.find((r) => r.id === rid);
    return known ? roomName(known) : rid === 0 ? 'not known' : `${rid}`;
  };
  switch (kind) {
    case 'rooms': return [roomName(item), [['type', item.type], ['area', area(item.area_m2)],
      ['explored', percent(item.explored)], ['evidence', item.evidence.toFixed(2)], ['corners', item.outline.length / 2], ['id', id]]];
    case 'doors': return [`Door ${id}`, [['state', item.state], ['width', metres(item.width_m)],
      ['between', item.rooms.map(room).join(' and ')], ['evidence', item.evidence.toFixed(2)], ['id', id]]];
    case 'walls': return [`Wall ${id}`, [['length', metres(item.length_m)], ['evidence', item.evidence.toFixed(2)],
      ['spread', `${(item.sigma_m * 1000).toFixed(0)} mm`], ['from', place(item.a)], ['to', place(item.b)], ['id', id]]];
    default: return [item.class || `Object ${id}`, [['class', item.class || 'not known'], ['area', `${item.area_m2.toFixed(2)} m²`],
      ['seen for', `${((item.last_utime - item.first_utime) / 1e6).toFixed(1)} s`], ['evidence', item.evidence.toFixed(2)], ['id', id]]];
  }
}
