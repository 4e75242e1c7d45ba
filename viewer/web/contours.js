// SPDX-License-Identifier: BSD-3-Clause
// Static contours: the occupied cells of the grid map that lie on walls. What is occupied and left out moved in, or will move out.

import {drawTiles} from './tiles.js';

const REACH_M = 0.15;  // of a wall's face: its thickness of evidence, and what the grid is coarse by

const occupiedOnly = new WeakMap();  // palette -> the same with nothing but occupied cells

function paletteOf(palette) {
  if (!occupiedOnly.has(palette)) {
    const rgb = [1, 3, 5].map((i) => parseInt(palette.contour.slice(i, i + 2), 16));
    const cells = new Uint8ClampedArray(256 * 4);
    for (let v = 129; v < 256; v++) cells.set([...rgb, 255], 4 * v);
    occupiedOnly.set(palette, {...palette, cells});
  }
  return occupiedOnly.get(palette);
}

function sheet(camera) {
  const canvas = document.createElement('canvas');
  canvas.width = camera.width;
  canvas.height = camera.height;
  return canvas.getContext('2d');
}

export function drawContours({ctx, state, camera, palette}) {
  const cells = sheet(camera), walls = sheet(camera);
  drawTiles({ctx: cells, state, camera, palette: paletteOf(palette)});
  walls.lineCap = 'round';
  walls.lineWidth = Math.max(3, 2 * REACH_M * camera.scale);
  walls.beginPath();
  for (const {a, b} of state.walls) {
    walls.moveTo(...camera.toScreen(...a));
    walls.lineTo(...camera.toScreen(...b));
  }
  walls.stroke();
  cells.globalCompositeOperation = 'destination-in';
  cells.drawImage(walls.canvas, 0, 0);
  ctx.drawImage(cells.canvas, 0, 0, camera.width, camera.height);
}
