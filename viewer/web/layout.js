// SPDX-License-Identifier: BSD-3-Clause
// The layout stands in the URL behind '#': a link, or a reload, shows the same.

export function readLayout(hash) {
  const words = new URLSearchParams(hash.replace(/^#/, ''));
  const view = words.get('view') ?? 'fit', numbers = view.split(',').map(Number);
  return {
    layers: words.has('layers') ? words.get('layers').split(',').filter(Boolean) : null,
    mode: ['fit', 'robot'].includes(view) ? view : numbers.length === 3 && numbers.every(Number.isFinite) ? 'free' : 'fit',
    camera: numbers.length === 3 && numbers.every(Number.isFinite) && numbers[2] > 0 ? numbers : null,
    scale: Number(words.get('scale')) || null,
    panel: words.has('panel') ? words.get('panel') !== '0' : null,
    theme: ['light', 'dark'].includes(words.get('theme')) ? words.get('theme') : null,
  };
}

export function writeLayout({visible, camera, panel, theme}) {
  const view = camera.mode === 'free' ? [camera.x.toFixed(2), camera.y.toFixed(2), camera.scale.toFixed(1)].join(',') : camera.mode;
  const words = [`layers=${[...visible].join(',')}`, `view=${view}`, `panel=${panel ? 1 : 0}`];
  if (camera.mode === 'robot') words.push(`scale=${camera.scale.toFixed(1)}`);
  if (theme) words.push(`theme=${theme}`);
  return `#${words.join('&')}`;
}
