// Playback of a recording: play, pause, speed and a slider; the data stands in the page.
"use strict";

class Recording {
  constructor(scene, rows, frames) {
    [this.rows, this.width, this.frames] = [rows, scene.width, frames];
    this.times = Float64Array.from({ length: frames }, (_, t) => scene.start_s + t / scene.rate_hz);
    this.gap = 1.5 / scene.rate_hz;
    this.cache = new Map();
  }

  static async unpack(scene, packed) {
    const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const counts = new Uint16Array(await new Response(stream).arrayBuffer());
    const { frames, low, step } = packed, rows = new Float32Array(frames * scene.width);
    for (let w = 0; w < scene.width; w++) {
      for (let t = 0, count = 0; t < frames; t++) {
        count = (count + counts[w * frames + t]) & 0xffff;
        rows[t * scene.width + w] = count === 0xffff ? NaN : low[w] + step[w] * count;
      }
    }
    return new Recording(scene, rows, frames);
  }

  column(at, factor) {
    const found = new Float32Array(this.frames);
    for (let t = 0; t < this.frames; t++) found[t] = this.rows[t * this.width + at] * factor;
    return found;
  }

  row(frame) {
    return this.rows.subarray(frame * this.width, (frame + 1) * this.width);
  }

  series(q) {
    if (!this.cache.has(q.id)) {
      const sds = q.sd_column >= 0 ? this.column(q.sd_column, q.factor) : null;
      this.cache.set(q.id, { times: this.times, values: this.column(q.column, q.factor), sds });
    }
    return this.cache.get(q.id);
  }
}

class Player {
  constructor(page, scene, recording) {
    [this.recording, this.rate, this.playing, this.speed] = [recording, scene.rate_hz, false, 1];
    this.first = this.frame = this.position = scene.first_tracked;
    this.onDraw = null;
    this.leader = null; // a video whose clock leads while it plays (viewer_video.js)
    this.view = new BodyScene(page.pane, scene);
    page.legend(this.view);
    this.panel = new Panel(page.column, scene.quantities, (time) => this.seek(time));
    this.panel.onChange = () => this.draw();
    this.controls(page.bar);
    this.draw();
    addEventListener("resize", () => this.draw());
    this.last = null;
    const step = (now) => { requestAnimationFrame(step); this.advance(now); };
    requestAnimationFrame(step);
  }

  controls(bar) {
    this.button = element("button", { className: "play", id: "play", title: word("play_title") });
    this.button.onclick = () => this.play(!this.playing);
    this.slider = element("input", { type: "range", id: "scrub", min: 0, max: this.recording.frames - 1, value: this.frame, ariaLabel: word("time") });
    this.slider.oninput = () => this.go(Number(this.slider.value));
    this.clock = element("span", { className: "clock", id: "clock" });
    this.speeds = element("select", { id: "speed", ariaLabel: word("speed") }, ...[0.1, 0.25, 0.5, 1, 2, 4].map((s) =>
      element("option", { value: s, textContent: `${shownNumber(s)}×`, selected: s === 1 })));
    this.speeds.onchange = () => { this.speed = Number(this.speeds.value); this.leader?.play(this.playing, this.speed); };
    const length = this.recording.frames / this.rate;
    this.span = length > 15 ? 10 : 0;
    this.spans = element("select", { id: "span", ariaLabel: word("span") }, ...[0, 5, 10, 20, 60].filter((s) => s < length).map((s) =>
      element("option", { value: s, textContent: s ? word("plot_seconds", s) : word("plot_all"), selected: s === this.span })));
    this.spans.onchange = () => { this.span = Number(this.spans.value); this.draw(); };
    bar.append(this.button, this.slider, this.clock, this.speeds, this.spans);
    this.play(false);
    addEventListener("keydown", (event) => {
      if (/INPUT|SELECT|TEXTAREA/.test(event.target.tagName) && event.target.type !== "range") return;
      const button = event.target.closest && event.target.closest("button, summary");
      if (event.key === " " && (!button || button === this.button)) { event.preventDefault(); this.play(!this.playing); }
      if (event.key === "ArrowRight" && event.target !== this.slider) this.go(this.frame + 1);
      if (event.key === "ArrowLeft" && event.target !== this.slider) this.go(this.frame - 1);
    });
  }

  play(on) {
    this.playing = on;
    this.button.textContent = on ? word("pause") : word("play");
    this.last = null;
    if (on && this.frame >= this.recording.frames - 1) this.go(this.first);
    this.leader?.play(on, this.speed);
  }

  get time() {
    return this.recording.times[0] + this.position / this.rate;
  }

  seek(time) {
    const start = this.recording.times[0];
    this.go(Math.round((time - start) * this.rate));
  }

  go(frame) {
    this.frame = Math.min(this.recording.frames - 1, Math.max(0, frame));
    this.position = this.frame;
    this.leader?.go(this.time);
    this.draw();
  }

  advance(now) {
    if (!this.playing) return;
    const passed = this.last === null ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    const led = this.leader?.clock(this.time) ?? null;
    if (led === null) this.position = this.position + passed * this.speed * this.rate;
    else this.position = (led - this.recording.times[0]) * this.rate;
    if (this.position >= this.recording.frames) this.go(this.first);
    const frame = Math.floor(this.position);
    if (frame !== this.frame) {
      this.frame = frame;
      this.draw();
    }
  }

  // The whole recording, or so many seconds around the present.
  window(now, start, end) {
    if (!this.span) return [start, Math.max(end, start + 1e-3)];
    const first = Math.max(start, Math.min(now - this.span / 2, end - this.span));
    return [first, first + this.span];
  }

  draw() {
    const { recording, frame } = this, row = recording.row(frame), times = recording.times;
    const end = times[recording.frames - 1];
    this.view.show(row);
    this.panel.draw(recording, row, this.window(times[frame], times[0], end), times[frame]);
    this.slider.value = frame;
    this.clock.textContent = word("clock", numeral(times[frame], 2), numeral(end, 2));
    if (this.onDraw) this.onDraw(row, times[frame]);
  }
}
