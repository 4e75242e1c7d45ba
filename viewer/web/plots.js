// SPDX-License-Identifier: BSD-3-Clause
// Figures over time, by dygraphs. A click on a plot goes to that time.

/* global Dygraph */
import {$, element} from './panel.js';

const cm = (column) => column.map((v) => (v === null ? null : 100 * v));
const PLOTS = [
  {id: 'error', title: 'Position [cm]', labels: ['error', 'sigma'], colors: ['loop', 'accent'],
    columns: (s) => [cm(s.error_m), cm(s.sigma_m)]},
  {id: 'verdicts', title: 'Verdicts [%]', labels: ['ok', 'degenerate', 'bad'], colors: ['good', 'warn', 'bad'],
    columns: (s) => [s.ok, s.degenerate, s.bad].map((c) => c.map((v) => (v === null ? null : 100 * v))),
    options: {stackedGraph: true, valueRange: [0, 101]}},
  {id: 'latency', title: 'Matcher, 99 % within [ms]', labels: ['ms'], colors: ['done'], columns: (s) => [s.latency_ms]},
  {id: 'missing', title: 'Messages lost or bad', labels: ['in all'], colors: ['bad'], columns: (s) => [s.missing],
    options: {stepPlot: true}},
];

export class Plots {
  // `seek(utime)` is called for a click; `cursor()` says which time is shown [us], or null.
  constructor({seek, cursor}) { Object.assign(this, {seek, cursor, graphs: new Map(), shown: null, utime: null}); }

  // Drawn anew with the next figures: colours have changed.
  restyle() {
    for (const graph of this.graphs.values()) graph.destroy();
    this.graphs.clear();
    $('plots').replaceChildren();
    this.shown = null;
  }

  update(series) {
    if (!series || !series.t.length || !$('plots').offsetParent) return;
    if (this.shown === series && this.utime === this.cursor()) return;
    this.shown = series;
    this.utime = this.cursor();
    for (const plot of PLOTS) this.draw(plot, series);
  }

  draw(plot, series) {
    const columns = plot.columns(series);
    const rows = series.t.map((t, i) => [t, ...columns.map((c) => c[i])]);
    if (columns.every((c) => c.every((v) => v === null))) return;
    const graph = this.graphs.get(plot.id);
    if (graph) graph.updateOptions({file: rows});
    else this.graphs.set(plot.id, this.make(plot, rows));
  }

  make(plot, rows) {
    const css = getComputedStyle(document.documentElement), color = (name) => css.getPropertyValue(`--${name}`).trim();
    const legend = element('span', 'legend'), box = element('div', 'plot');
    box.dataset.plot = plot.id;
    $('plots').append(element('h3', '', plot.title, legend), box);
    return new Dygraph(box, rows, {
      labels: ['s', ...plot.labels], colors: plot.colors.map(color), strokeWidth: 1.4, connectSeparatedPoints: true,
      labelsDiv: legend, legend: 'always', digitsAfterDecimal: 1, includeZero: true, highlightCircleSize: 3,
      axisLineColor: color('line'), gridLineColor: color('line'), gridLineWidth: 0.6, axisLabelFontSize: 10,
      axes: {y: {axisLabelWidth: 30, pixelsPerLabel: 22}, x: {pixelsPerLabel: 50}}, drawAxesAtZero: false,
      interactionModel: {}, legendFormatter: (data) => this.words(data),
      underlayCallback: (ctx, area, graph) => this.mark(ctx, area, graph, color('ink')),
      clickCallback: (event, t) => this.seekTo(t), ...plot.options,
    });
  }

  // What labels and numbers say; both are this page's own words.
  words(data) {
    const words = document.createDocumentFragment();
    for (const line of data.series) {
      const part = element('span', '', `${line.label}${line.yHTML === undefined ? '' : ` ${line.yHTML}`}`);
      part.style.color = line.color;
      words.append(part, ' ');
    }
    return words;
  }

  mark(ctx, area, graph, color) {
    if (this.utime === null || !this.shown) return;
    const x = graph.toDomXCoord((this.utime - this.shown.begin_utime) / 1e6);
    ctx.fillStyle = color;
    ctx.fillRect(Math.min(area.x + area.w, Math.max(area.x, x)) - 0.5, area.y, 1, area.h);
  }

  seekTo(t) { if (this.shown) this.seek(this.shown.begin_utime + t * 1e6); }
}
