// SPDX-License-Identifier: BSD-3-Clause
// Colours: named ones stand in style.css, light and dark; rooms get theirs from their id.

const NAMES = ['retracted', 'refused', 'unknown', 'free', 'occupied', 'contour', 'grid', 'ink', 'quiet', 'accent', 'path', 'node', 'loop', 'truth', 'scan',
  'robot', 'wall', 'door-open', 'door-closed', 'door-unknown', 'object', 'halo', 'room', 'corridor', 'doorway'];
const ROOM_HUES = [172, 42, 262, 96, 12, 212, 318, 66, 240, 140, 28, 290];

export const darkQuery = window.matchMedia('(prefers-color-scheme: dark)');
const isDark = () => document.documentElement.dataset.theme === 'dark';

// 'light', 'dark', or null for what the system likes.
export function setTheme(theme) {
  document.documentElement.dataset.theme = theme ?? (darkQuery.matches ? 'dark' : 'light');
}

export function readPalette() {
  const css = getComputedStyle(document.documentElement);
  const colors = Object.fromEntries(NAMES.map((n) => [n, css.getPropertyValue(`--${n}`).trim()]));
  return {...colors, dark: isDark(), cells: cellColors(colors)};
}

export function roomColor(id, alpha = 1) {
  const hue = ROOM_HUES[Math.abs(Number(id)) % ROOM_HUES.length];
  const [s, l] = isDark() ? [42, 55] : [52, 58];
  return `hsl(${hue} ${s}% ${l}% / ${alpha})`;
}

// RGBA of the 256 cell values: 0 is unknown and lets the background through, then from free to occupied.
function cellColors({free, occupied}) {
  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  const [f, o] = [rgb(free), rgb(occupied)];
  const table = new Uint8ClampedArray(256 * 4);
  for (let v = 1; v < 256; v++) {
    const p = (v - 1) / 254;
    const known = Math.min(1, Math.abs(p - 0.5) * 5);  // what is undecided is nearly unknown
    for (let i = 0; i < 3; i++) table[4 * v + i] = f[i] + (o[i] - f[i]) * p;
    table[4 * v + 3] = 255 * known;
  }
  return table;
}
