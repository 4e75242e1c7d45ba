// SPDX-License-Identifier: BSD-3-Clause
// What stands still is painted once and shown again: a big map costs a frame only when it changes or the view has moved.

const CHEAP_MS = 10;      // what may be spent in every frame
const REST = 8;           // a dear painting is followed by eight times its time without another

export class Backdrop {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.ctx = this.canvas.getContext('2d');
    this.key = null;
    this.cost = 0;
    this.at = -Infinity;
  }

  // Shows the picture of `key` under `camera`; `draw(ctx)` paints it. @return false when an old one was shown for now.
  show(target, camera, ratio, key, draw) {
    const view = [camera.x, camera.y, camera.scale, camera.width, camera.height, ratio].join('/');
    const fresh = this.key === key && this.view === view, now = performance.now();
    const waits = !fresh && this.cost > CHEAP_MS && now - this.at < REST * this.cost;
    if (!fresh && !waits) {
      this.canvas.width = Math.round(camera.width * ratio);
      this.canvas.height = Math.round(camera.height * ratio);
      this.ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
      draw(this.ctx);
      Object.assign(this, {key, view, camera: {...camera}});
      this.at = performance.now();
      this.cost = this.at - now;
    }
    this.copy(target, camera);
    return !waits;
  }

  // Moved and scaled to where it belongs now.
  copy(target, camera) {
    const zoom = camera.scale / this.camera.scale;
    const x = camera.width / 2 + (this.camera.x - camera.x) * camera.scale - this.camera.width / 2 * zoom;
    const y = camera.height / 2 - (this.camera.y - camera.y) * camera.scale - this.camera.height / 2 * zoom;
    target.drawImage(this.canvas, x, y, this.camera.width * zoom, this.camera.height * zoom);
  }
}
