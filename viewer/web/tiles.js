// SPDX-License-Identifier: BSD-3-Clause
// The grid map. Tiles are painted once into blocks of many, in full and, for the view from afar, in small: what costs is
// the number of pictures that a frame is put together from.

const BLOCK_PX = 512, SMALL_PX = 32;  // sides of a block, and of a tile seen from afar
const blocksOf = new WeakMap();       // palette -> 'side of a tile/x/y' -> {canvas, ctx, palette, drawn}
const scratch = document.createElement('canvas');

function blockOf(px, x, y, palette) {
  const key = `${px}/${x}/${y}`;
  if (!blocksOf.has(palette)) blocksOf.set(palette, new Map());
  const blocks = blocksOf.get(palette);
  let block = blocks.get(key);
  if (block) return block;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = px * tilesABlock(px);
  block = {canvas, ctx: canvas.getContext('2d'), palette, drawn: new Map(), x, y};  // drawn: 'x/y' of a tile -> {tile, cells}
  blocks.set(key, block);
  return block;
}

const tilesABlock = (px) => Math.max(1, Math.floor(BLOCK_PX / px));

function paintCells(tile, palette) {
  const n = tile.ncells, pixels = new ImageData(n, n);
  const from = new Uint32Array(palette.cells.buffer), to = new Uint32Array(pixels.data.buffer);
  for (let row = 0; row < n; row++)
    for (let col = 0; col < n; col++) to[(n - 1 - row) * n + col] = from[tile.cells[row * n + col]];
  scratch.width = scratch.height = n;
  scratch.getContext('2d').putImageData(pixels, 0, 0);
  return scratch;
}

function put(block, px, key, tile) {
  if (block.drawn.get(key)?.cells === tile.cells) return;
  erase(block, px, tile);
  const [x, y] = placeIn(block, px, tile);
  block.ctx.imageSmoothingQuality = 'high';
  block.ctx.drawImage(paintCells(tile, block.palette), x, y, px, px);
  block.drawn.set(key, {tile, cells: tile.cells});
}

function placeIn(block, px, tile) {
  const count = tilesABlock(px);
  return [(tile.x - block.x * count) * px, (count - 1 - tile.y + block.y * count) * px];
}

function erase(block, px, tile) { block.ctx.clearRect(...placeIn(block, px, tile), px, px); }

export function drawTiles({ctx, state, camera, palette}) {
  const shown = new Map();  // block -> side of its tiles [m]
  for (const [key, tile] of state.tiles) {
    if (!tile.cells) continue;
    const side = tile.ncells * tile.resolution, at = side * camera.scale;
    const [l, b] = camera.toScreen(tile.x * side, tile.y * side);
    if (l + at < 0 || b < 0 || l > camera.width || b - at > camera.height) continue;
    const px = at <= SMALL_PX ? SMALL_PX : tile.ncells, count = tilesABlock(px);
    const block = blockOf(px, Math.floor(tile.x / count), Math.floor(tile.y / count), palette);
    put(block, px, key, tile);
    shown.set(block, {px, count, side, resolution: tile.resolution});
  }
  for (const [block, {px, count, side, resolution}] of shown) {
    for (const [key, {tile}] of block.drawn)
      if (!state.tiles.get(key)?.cells) { erase(block, px, tile); block.drawn.delete(key); }
    const [l, b] = camera.toScreen(block.x * count * side, block.y * count * side).map(Math.round);
    const [r, t] = camera.toScreen((block.x + 1) * count * side, (block.y + 1) * count * side).map(Math.round);
    ctx.imageSmoothingEnabled = camera.scale * resolution < 1;
    ctx.drawImage(block.canvas, l, t, r - l, b - t);
  }
}
