// SPDX-License-Identifier: BSD-3-Clause
// Between map metres (x right, y up) and screen pixels (y down), and the hands that move the view.

const MIN_SCALE = 0.5, MAX_SCALE = 2000;  // pixels a metre

export class Camera {
  constructor() { this.x = 0; this.y = 0; this.scale = 40; this.width = 1; this.height = 1; this.mode = 'fit'; }

  toScreen(x, y) { return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale]; }
  toMap(px, py) { return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale]; }

  pan(dx, dy) { this.x -= dx / this.scale; this.y += dy / this.scale; this.mode = 'free'; }

  // Keeps the map point under (px, py) where it is; following the robot goes on.
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toMap(px, py);
    this.scale = Math.min(MAX_SCALE, Math.max(MIN_SCALE, this.scale * factor));
    if (this.mode === 'robot') return;
    this.mode = 'free';
    const [nx, ny] = this.toMap(px, py);
    this.x += x - nx; this.y += y - ny;
  }

  fit([x0, y0, x1, y1]) {
    const margin = 60, bars = 24;  // the time line is higher than the buttons
    const w = Math.max(x1 - x0, 4), h = Math.max(y1 - y0, 4);
    const scale = Math.min((this.width - 2 * margin) / w, (this.height - 2 * margin - bars) / h);
    this.scale = Math.min(MAX_SCALE, Math.max(MIN_SCALE, scale));
    this.x = (x0 + x1) / 2; this.y = (y0 + y1) / 2 - bars / 2 / this.scale;
  }
}

// Mouse, touch and pen on the canvas. Calls click(px, py), hover(px, py) or hover(null), and changed().
export function moveByHand(canvas, camera, {click, hover, changed}) {
  const down = new Map();
  let moved = false;

  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    if (down.size === 0) moved = false;
    down.set(e.pointerId, [e.offsetX, e.offsetY]);
  });
  canvas.addEventListener('pointermove', (e) => {
    const here = [e.offsetX, e.offsetY], last = down.get(e.pointerId);
    hover(...here);
    if (!last) return;
    const [dx, dy] = [here[0] - last[0], here[1] - last[1]];
    if (!moved && Math.hypot(dx, dy) < 4) return;  // a click trembles
    moved = true;
    canvas.classList.add('dragging');
    if (down.size === 2) {
      const other = [...down].find(([id]) => id !== e.pointerId)[1];
      const gap = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      camera.pan(dx / 2, dy / 2);
      if (gap(last) > 0) camera.zoom(gap(here) / gap(last), (here[0] + other[0]) / 2, (here[1] + other[1]) / 2);
    } else {
      camera.pan(dx, dy);
    }
    down.set(e.pointerId, here);
    changed();
  });
  const up = (e) => {
    if (!down.delete(e.pointerId)) return;
    canvas.classList.remove('dragging');
    if (!moved && e.type === 'pointerup') click(e.offsetX, e.offsetY);
  };
  canvas.addEventListener('pointerup', up);
  canvas.addEventListener('pointercancel', up);
  canvas.addEventListener('pointerleave', () => hover(null));
  canvas.addEventListener('wheel', (e) => {
    e.preventDefault();
    const lines = e.deltaMode === 1 ? 30 : 1;
    camera.zoom(Math.exp(-e.deltaY * lines * 0.0015), e.offsetX, e.offsetY);
    changed();
  }, {passive: false});
}
