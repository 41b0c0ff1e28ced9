// One curve with its ±2σ band against time on a canvas, with an optional target band and a playhead.
"use strict";

// At most `wanted` round numbers that divide low … high.
function ticks(low, high, wanted) {
  const raw = (high - low) / Math.max(1, wanted), power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return { found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function readable(value, step) {
  return numeral(value, Math.max(0, Math.min(3, step)));
}

class Curve {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.margin = { left: 46, right: 10, top: 8, bottom: 20 };
  }

  // times, values, sds: arrays of one length (NaN where unknown; sds may be null); window: [t0, t1] shown;
  // options: colour, target [low, high] or null, playhead (a time or null), gap: seconds that break the line,
  // other: times and values of a second, dashed curve, marks: instants with time, colour and dashed.
  draw(times, values, sds, window, options) {
    const ratio = Math.min(2, devicePixelRatio || 1), c = this.canvas, g = this.context;
    const width = c.clientWidth, height = c.clientHeight;
    if (!width || !height) return;
    if (c.width !== Math.round(width * ratio) || c.height !== Math.round(height * ratio)) {
      c.width = Math.round(width * ratio);
      c.height = Math.round(height * ratio);
    }
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    const m = this.margin, [low, high] = this.range(times, values, sds, window, options.target, options.other);
    const x = (t) => m.left + ((t - window[0]) / (window[1] - window[0])) * (width - m.left - m.right);
    const y = (v) => height - m.bottom - ((v - low) / (high - low)) * (height - m.top - m.bottom);
    this.x = x;
    this.window = window;
    this.axes(g, width, height, x, y, window, low, high);
    g.save();
    g.beginPath();
    g.rect(m.left, m.top, width - m.left - m.right, height - m.top - m.bottom);
    g.clip();
    if (options.target) this.target(g, width, y, options.target);
    this.marks(g, x, height, options.marks || []);
    if (options.other) this.other(g, options.other, x, y, window, options);
    if (sds) this.band(g, times, values, sds, x, y, window, options);
    this.line(g, times, values, x, y, window, options);
    if (options.playhead != null) this.playhead(g, x(options.playhead), height);
    g.restore();
  }

  range(times, values, sds, window, target, other) {
    let low = Infinity, high = -Infinity;
    for (const curve of [{ times, values }, ...(other ? [other] : [])]) {
      for (let i = 0; i < curve.times.length; i++) {
        if (curve.times[i] < window[0] || curve.times[i] > window[1] || Number.isNaN(curve.values[i])) continue;
        low = Math.min(low, curve.values[i]);
        high = Math.max(high, curve.values[i]);
      }
    }
    if (target) [low, high] = [Math.min(low, target[0]), Math.max(high, target[1])];
    if (low > high) return [-1, 1];
    const spread = sds ? this.spread(times, sds, window) : 0;
    [low, high] = [low - spread, high + spread];
    const least = Math.max(1e-3, 0.02 * Math.max(Math.abs(low), Math.abs(high)));
    const margin = Math.max(least, 0.08 * (high - low));
    return [low - margin, high + margin];
  }

  // What the axis leaves for the band: the median 2σ, so that a few wild ones do not flatten the curve.
  spread(times, sds, window) {
    const known = sds.filter((s, i) => times[i] >= window[0] && times[i] <= window[1] && !Number.isNaN(s));
    return known.length ? 2 * known.sort((a, b) => a - b)[known.length >> 1] : 0;
  }

  axes(g, width, height, x, y, window, low, high) {
    const m = this.margin;
    g.font = "11px system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif";
    g.lineWidth = 1;
    const across = ticks(window[0], window[1], width / 72), up = ticks(low, high, (height - 28) / 24);
    g.textAlign = "right";
    g.textBaseline = "middle";
    for (const v of up.found) {
      g.strokeStyle = Math.abs(v) < 1e-9 ? "#aab4bf" : COLOURS.grid;
      g.beginPath();
      g.moveTo(m.left, y(v));
      g.lineTo(width - m.right, y(v));
      g.stroke();
      g.fillStyle = COLOURS.axis;
      g.fillText(readable(v, up.digits), m.left - 6, y(v));
    }
    g.textAlign = "center";
    g.textBaseline = "top";
    for (const t of across.found) {
      g.strokeStyle = COLOURS.grid;
      g.beginPath();
      g.moveTo(x(t), m.top);
      g.lineTo(x(t), height - m.bottom);
      g.stroke();
      const near = x(t) > width - m.right - 14;
      g.fillText(readable(t, across.digits) + (t === across.found[across.found.length - 1] ? " s" : ""), x(t) - (near ? 8 : 0), height - m.bottom + 5);
    }
  }

  target(g, width, y, [low, high]) {
    g.fillStyle = "rgba(0, 158, 115, 0.15)";
    g.fillRect(this.margin.left, y(high), width, y(low) - y(high));
    g.strokeStyle = COLOURS.target;
    g.setLineDash([5, 4]);
    for (const edge of [low, high]) {
      g.beginPath();
      g.moveTo(this.margin.left, y(edge));
      g.lineTo(width, y(edge));
      g.stroke();
    }
    g.setLineDash([]);
  }

  // Stretches of neighbouring samples that are known and inside the window, one beyond each end.
  *stretches(times, known, window, gap) {
    let run = [];
    for (let i = 0; i < times.length; i++) {
      const inside = (times[i + 1] ?? times[i]) >= window[0] && (times[i - 1] ?? times[i]) <= window[1];
      const broken = run.length && times[i] - times[run[run.length - 1]] > gap;
      if (run.length && (broken || !inside || !known(i))) {
        yield run;
        run = [];
      }
      if (inside && known(i)) run.push(i);
    }
    if (run.length) yield run;
  }

  band(g, times, values, sds, x, y, window, options) {
    g.fillStyle = options.colour + "30";
    const known = (i) => !Number.isNaN(values[i]) && !Number.isNaN(sds[i]);
    for (const run of this.stretches(times, known, window, options.gap)) {
      g.beginPath();
      for (const i of run) g.lineTo(x(times[i]), y(values[i] + 2 * sds[i]));
      for (const i of run.reverse()) g.lineTo(x(times[i]), y(values[i] - 2 * sds[i]));
      g.fill();
    }
  }

  line(g, times, values, x, y, window, options) {
    g.strokeStyle = options.colour;
    g.lineWidth = 1.8;
    g.lineJoin = "round";
    for (const run of this.stretches(times, (i) => !Number.isNaN(values[i]), window, options.gap)) {
      g.beginPath();
      for (const i of run) g.lineTo(x(times[i]), y(values[i]));
      g.stroke();
    }
  }

  // The same quantity in another trial.
  other(g, { times, values }, x, y, window, options) {
    g.save();
    g.setLineDash([5, 4]);
    this.line(g, times, values, x, y, window, { colour: COLOURS.other, gap: options.gap });
    g.restore();
  }

  marks(g, x, height, marks) {
    g.save();
    g.lineWidth = 1;
    for (const { time, colour, dashed } of marks) {
      g.strokeStyle = colour + "99";
      g.setLineDash(dashed ? [2, 3] : []);
      g.beginPath();
      g.moveTo(x(time), this.margin.top);
      g.lineTo(x(time), height - this.margin.bottom);
      g.stroke();
    }
    g.restore();
  }

  playhead(g, at, height) {
    g.strokeStyle = COLOURS.text;
    g.lineWidth = 1.2;
    g.beginPath();
    g.moveTo(at, this.margin.top);
    g.lineTo(at, height - this.margin.bottom);
    g.stroke();
  }

  // The time under a place on the canvas.
  timeAt(clientX) {
    const box = this.canvas.getBoundingClientRect(), m = this.margin;
    const share = (clientX - box.left - m.left) / (box.width - m.left - m.right);
    return this.window[0] + Math.min(1, Math.max(0, share)) * (this.window[1] - this.window[0]);
  }
}
