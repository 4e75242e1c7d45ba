// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/page.hpp"

namespace modslam::report {

const char* const kPageStyle = R"css(
:root { color-scheme: light dark;
  --paper: #f6f7f9; --card: #ffffff; --ink: #1b1f27; --soft: #667085; --rule: #e2e6ec; --sheet: #e9ecf1;
  --ours: #1f5fd6; --truth: #12805c; --odometry: #b7791f; --wall: #c8324a; --door: #e08a00; --loop: #8b3fc7;
  --ok: #4fae7b; --first: #9bb8d3; --degenerate: #e7c24a; --ambiguous: #f0953f; --low: #e2663c; --bad: #c8324a; --failed: #7d1128; }
@media screen and (prefers-color-scheme: dark) { :root {
  --paper: #12151b; --card: #1a1f28; --ink: #e7eaf0; --soft: #98a2b3; --rule: #2c3340; --sheet: #232a35;
  --ours: #6ea3ff; --truth: #47c79a; --odometry: #d9a441; --wall: #ff6b81; --door: #ffb340; --loop: #c48bff; }
  .grid-map { filter: invert(0.9); } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 28px 24px 60px; }
header h1 { margin: 0; font-size: 28px; letter-spacing: -0.01em; }
header p { margin: 2px 0 18px; color: var(--soft); }
h2 { font-size: 18px; margin: 0 0 10px; }
section { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 18px 20px; margin-top: 16px; }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(168px, 1fr)); gap: 12px; }
.fact { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 12px 16px; }
.fact b { display: block; font-size: 24px; font-weight: 650; line-height: 1.25; font-variant-numeric: tabular-nums; }
.fact span { color: var(--soft); font-size: 13px; display: block; line-height: 1.35; }
.warning { border-left: 5px solid var(--bad); }
.note { color: var(--soft); font-size: 13.5px; margin: 6px 0 0; }
.switches, .legend { display: flex; flex-wrap: wrap; gap: 6px 18px; margin-bottom: 10px; font-size: 14px; }
.switches label { cursor: pointer; display: inline-flex; align-items: center; gap: 5px; }
.legend span { display: inline-flex; align-items: center; gap: 6px; }
.swatch { display: inline-block; width: 16px; height: 10px; border-radius: 2px; background: var(--soft); }
.swatch.path { background: var(--ours); } .swatch.truth { background: var(--truth); } .swatch.odometry { background: var(--odometry); }
.swatch.walls { background: var(--wall); } .swatch.doors { background: var(--door); } .swatch.loops { background: var(--loop); }
.swatch.world { background: none; border: 3px solid #12805c66; height: 12px; } .swatch.graph { height: 2px; }
.swatch.rooms { background: #7fb8d8; } .swatch.objects { background: #8d7b68; } .swatch.map { background: linear-gradient(90deg, #fff 50%, #222 50%); border: 1px solid var(--rule); }
svg { display: block; width: 100%; height: auto; margin: 0 auto; }
svg.plot { max-width: 1080px; }
text { font-family: inherit; fill: var(--ink); }
.tick { font-size: 11px; fill: var(--soft); }
.plot-title { font-size: 13px; font-weight: 600; }
.sheet { fill: var(--sheet); } .map .lattice { stroke: var(--soft); stroke-opacity: 0.18; }
.lattice { stroke: var(--rule); stroke-width: 1; }
.grid-map { image-rendering: pixelated; }
.path, .curve { fill: none; stroke-linejoin: round; }
.path.ours { stroke: var(--ours); stroke-width: 1.8; } .path.truth { stroke: var(--truth); stroke-width: 3.2; stroke-opacity: 0.55; }
.path.odometry { stroke: var(--odometry); stroke-width: 1.2; stroke-dasharray: 5 3; }
.curve.ours { stroke: var(--ours); stroke-width: 1.8; } .curve.odometry { stroke: var(--odometry); stroke-width: 1.3; }
.curve[class*="run"] { stroke-width: 1.5; }
.curve.run0 { stroke: #1f5fd6; } .curve.run1 { stroke: #c8324a; } .curve.run2 { stroke: #12805c; }
.curve.run3 { stroke: #b7791f; } .curve.run4 { stroke: #8b3fc7; } .curve.run5 { stroke: #6d5c49; }
.swatch.run0 { background: #1f5fd6; } .swatch.run1 { background: #c8324a; } .swatch.run2 { background: #12805c; }
.swatch.run3 { background: #b7791f; } .swatch.run4 { background: #8b3fc7; } .swatch.run5 { background: #6d5c49; }
.room { stroke: none; fill-opacity: 0.32; } .tone0 { fill: #5aa9d6; } .tone1 { fill: #74b87a; } .tone2 { fill: #d8a64a; }
.tone3 { fill: #b58ad0; } .tone4 { fill: #e08a84; } .tone5 { fill: #56b8ad; } .corridor { fill: #8a94a6; }
.room-name { font-size: 13px; font-weight: 600; } .room-area { font-size: 11.5px; }
.room-name, .room-area { text-anchor: middle; paint-order: stroke; stroke: var(--card); stroke-width: 3px; stroke-opacity: 0.8; }
.wall { stroke: var(--wall); stroke-width: 2.6; stroke-linecap: round; }
.door { stroke: var(--door); stroke-width: 5; } .door.closed { stroke-dasharray: 3 2; } .jamb { fill: var(--door); stroke: var(--card); }
.object { fill: #8d7b68; fill-opacity: 0.55; stroke: #6d5c49; }
.true-wall { fill: none; stroke: var(--truth); stroke-opacity: 0.4; stroke-width: 6; } .true-door { fill: none; stroke: var(--truth); stroke-dasharray: 2 3; stroke-width: 2; }
.loop { stroke: var(--loop); stroke-width: 1.6; } .edge { stroke: var(--soft); } .node { fill: var(--soft); }
.end { fill: var(--ours); stroke: var(--card); stroke-width: 1.5; } .end-name { font-size: 9.5px; font-weight: 700; fill: var(--card); text-anchor: middle; }
.v0, .s0 { fill: var(--failed); stroke: none; background: var(--failed); } .v1 { fill: var(--ok); background: var(--ok); }
.v2 { fill: var(--degenerate); background: var(--degenerate); } .v3 { fill: var(--ambiguous); background: var(--ambiguous); }
.v4 { fill: var(--low); background: var(--low); } .v5 { fill: var(--bad); background: var(--bad); }
.v6 { fill: var(--failed); background: var(--failed); } .v7 { fill: var(--first); background: var(--first); }
.mark { stroke-width: 1.6; stroke: var(--failed); } .s1 { stroke: var(--loop); } .s2 { stroke: var(--degenerate); } .s3 { stroke: var(--ambiguous); }
.s4 { stroke: var(--low); } .s5 { stroke: var(--bad); }
table { border-collapse: collapse; font-size: 13.5px; font-variant-numeric: tabular-nums; width: 100%; }
th { text-align: left; font-weight: 600; color: var(--soft); } th, td { padding: 4px 12px 4px 0; border-bottom: 1px solid var(--rule); }
td.n, th.n { text-align: right; }
.columns { display: grid; grid-template-columns: repeat(auto-fit, minmax(330px, 1fr)); gap: 12px 36px; }
details { margin-top: 10px; } summary { cursor: pointer; font-weight: 600; }
pre { font: 12.5px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; overflow: auto; max-height: 460px; background: var(--paper); padding: 12px; border-radius: 8px; }
@media print { body { background: #fff; font-size: 12px; } main { padding: 0; max-width: none; } section, .fact { break-inside: avoid; border-color: #ccc; } .switches input { display: none; } }
)css";

const char* const kPageScript = R"js(
const folder = decodeURIComponent(location.pathname).split('/').slice(-2)[0];
if (folder) { document.getElementById('run').textContent = folder; document.title = folder + ' - ModSLAM'; }
for (const box of document.querySelectorAll('[data-layer]')) {
  const layer = document.getElementById('layer-' + box.dataset.layer);
  box.onchange = () => { layer.style.display = box.checked ? '' : 'none'; };
  box.onchange();
}
function modslam_timing(timing) {
  const place = document.getElementById('timing');
  place.textContent = '';
  const add = (parent, tag, words) => {
    const element = parent.appendChild(document.createElement(tag));
    if (words !== undefined) {
      element.textContent = words;
      if (typeof words === 'number') element.className = 'n';
    }
    return element;
  };
  const is_row = (value) => value !== null && typeof value === 'object';
  const plain = Object.entries(timing).filter(([, value]) => !is_row(value));
  if (plain.length) {
    const table = add(place, 'table');
    for (const [key, value] of plain) { const row = add(table, 'tr'); add(row, 'td', key); add(row, 'td', value); }
  }
  for (const [key, value] of Object.entries(timing).filter(([, v]) => is_row(v))) {
    add(place, 'h3', key);
    const rows = Array.isArray(value) ? value : Object.entries(value).map(([name, v]) => is_row(v) ? { name, ...v } : { name, value: v });
    const columns = [...new Set(rows.flatMap((row) => Object.keys(row)))];
    const table = add(place, 'table'), head = add(table, 'tr');
    for (const column of columns) {
      const cell = add(head, 'th', column);
      if (rows.some((row) => typeof row[column] === 'number')) cell.className = 'n';
    }
    for (const row of rows) { const line = add(table, 'tr'); for (const column of columns) add(line, 'td', row[column] ?? ''); }
  }
}
)js";

}  // namespace modslam::report
