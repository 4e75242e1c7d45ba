// SPDX-License-Identifier: BSD-3-Clause
// Small plane geometry on flat outlines [x0, y0, x1, y1, ...].

export function inside(outline, x, y) {
  let odd = false;
  for (let i = 0, j = outline.length - 2; i < outline.length; j = i, i += 2) {
    const [xi, yi, xj, yj] = [outline[i], outline[i + 1], outline[j], outline[j + 1]];
    if ((yi > y) !== (yj > y) && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) odd = !odd;
  }
  return odd;
}

export function toSegment(x, y, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length2 = dx * dx + dy * dy;
  const t = length2 > 0 ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / length2)) : 0;
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

export function toEdge(outline, x, y) {
  let least = Infinity;
  for (let i = 0, j = outline.length - 2; i < outline.length; j = i, i += 2)
    least = Math.min(least, toSegment(x, y, [outline[j], outline[j + 1]], [outline[i], outline[i + 1]]));
  return least;
}

// A place for a label: inside, as far from the edges as a coarse search finds, rather in the middle than not.
export function middle(outline) {
  const xs = outline.filter((_, i) => i % 2 === 0), ys = outline.filter((_, i) => i % 2 === 1);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const [cx, cy] = [(x0 + x1) / 2, (y0 + y1) / 2];
  let best = {x: cx, y: cy, room: 0, worth: -Infinity};
  const n = 16;
  for (let i = 1; i < n; i++) {
    for (let j = 1; j < n; j++) {
      const x = x0 + ((x1 - x0) * i) / n, y = y0 + ((y1 - y0) * j) / n;
      if (!inside(outline, x, y)) continue;
      const room = toEdge(outline, x, y);
      const worth = room - 0.1 * Math.hypot(x - cx, y - cy);
      if (worth > best.worth) best = {x, y, room, worth};
    }
  }
  return best;
}
