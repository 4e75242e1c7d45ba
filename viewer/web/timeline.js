// SPDX-License-Identifier: BSD-3-Clause
// Pause, scrub back through the run, play it again, go live; and drive the player of a log where there is one.
// The page's own state goes on being fed while the past is shown.

import {$} from './panel.js';
import {readPast} from './state.js';

const TICK_MS = 200;

export class Timeline {
  // `query` is put behind every request; `show(state)` shows a past state, or the live one for null.
  constructor(live, {query, show, send}) {
    Object.assign(this, {live, query, show, send, utime: null, playing: false, speed: 1, wanted: null, busy: false});
    $('time').addEventListener('input', () => this.seek(this.begin + Number($('time').value) * 1e6));
    $('pause').onclick = () => this.toggle();
    $('live').onclick = () => this.goLive();
    $('step-back').onclick = () => this.step(-1);
    $('step-on').onclick = () => this.step(1);
    $('past-speed').onchange = () => { this.speed = Number($('past-speed').value); };
    $('replay-play').onclick = () => this.send(this.live.playback?.paused ? 'play' : 'pause');
    $('replay-step').onclick = () => this.send('step');
    $('replay-speed').onchange = () => this.send(`speed ${$('replay-speed').value}`);
    setInterval(() => this.tick(), TICK_MS);
  }

  get begin() { return this.live.clock?.past[0] ?? 0; }
  get end() { return this.live.clock?.past[1] ?? 0; }
  get isLive() { return this.utime === null; }

  goLive() { this.utime = this.wanted = null; this.playing = false; this.show(null); this.update(); }

  // Pauses what is live; in the past, plays and halts.
  toggle() {
    if (this.isLive) this.seek(this.end);
    else this.playing = !this.playing;
    this.update();
  }

  step(direction) {
    this.playing = false;
    this.seek((this.utime ?? this.end) + direction * Math.max(500e3, this.live.clock?.past_step_us ?? 0));
  }

  seek(utime) {
    if (this.end <= this.begin) return;
    this.utime = Math.min(this.end, Math.max(this.begin, utime));
    this.wanted = this.utime;
    this.update();
    this.fetch();
  }

  // One request at a time; what was wanted meanwhile comes next.
  async fetch() {
    if (this.busy || this.wanted === null) return;
    this.busy = true;
    const utime = this.wanted;
    this.wanted = null;
    try {
      const answer = await fetch(`past?utime=${Math.round(utime)}${this.query ? `&${this.query}` : ''}`);
      if (answer.ok) {
        const past = await readPast(await answer.arrayBuffer());
        if (!this.isLive) this.show(past);
      } else if (answer.status === 429) {
        this.wanted ??= utime;
      }
    } catch { /* the viewer is gone: the banner says so */ }
    this.busy = false;
    if (this.wanted !== null) setTimeout(() => this.fetch(), 30);
  }

  tick() {
    if (this.playing && this.wanted === null && !this.busy) {
      const next = this.utime + TICK_MS * 1e3 * this.speed;
      if (next >= this.end) this.goLive(); else this.seek(next);
    }
    this.update();
  }

  update() {
    const length = (this.end - this.begin) / 1e6, at = this.isLive ? length : (this.utime - this.begin) / 1e6;
    const range = $('time');
    range.max = length.toFixed(1);
    range.disabled = !(length > 0);
    if (document.activeElement !== range || !range.matches(':active')) range.value = at.toFixed(2);
    $('time-text').textContent = length > 0 ? `${clockTime(at)} / ${clockTime(length)}` : 'no run yet';
    $('timeline').classList.toggle('past', !this.isLive);
    $('live').setAttribute('aria-pressed', this.isLive);
    const halted = !this.isLive && !this.playing;
    $('pause').textContent = halted ? 'Play' : 'Pause';
    this.updateReplay();
  }

  updateReplay() {
    const playback = this.live.playback, clock = this.live.clock;
    const there = playback && clock && clock.now_ms - playback.seen_ms < 3000;
    $('replay').hidden = !there;
    if (!there) return;
    $('replay-play').textContent = playback.paused ? 'Play' : 'Pause';
    $('replay-text').textContent = `${clockTime(playback.position_s)} / ${clockTime(playback.length_s)}${playback.ended ? ', at the end' : ''}`;
    if (document.activeElement === $('replay-speed')) return;
    if (![...$('replay-speed').options].some((option) => Number(option.value) === playback.speed))
      $('replay-speed').add(new Option(`${playback.speed}×`, String(playback.speed)));  // one that was set elsewhere
    $('replay-speed').value = String(playback.speed);
  }
}

export function clockTime(seconds) {
  const s = Math.max(0, seconds);
  return `${Math.floor(s / 60)}:${(s % 60).toFixed(1).padStart(4, '0')}`;
}
