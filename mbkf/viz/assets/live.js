// The live page: rows arrive over a WebSocket; the newest is drawn, the last seconds are plotted.
"use strict";

const KEPT_S = 60;

class Stream {
  constructor(scene) {
    this.scene = scene;
    this.rows = [];
    this.gap = 0.5;
  }

  push(row) {
    const last = this.rows[this.rows.length - 1];
    if (last && row[0] < last[0]) this.rows = []; // the stream began anew
    this.rows.push(row);
    while (this.rows[0][0] < row[0] - KEPT_S) this.rows.shift();
  }

  series(q) {
    const take = (at, factor) => Float32Array.from(this.rows, (row) => row[at] * factor);
    return { times: take(0, 1), values: take(q.column, q.factor), sds: q.sd_column >= 0 ? take(q.sd_column, q.factor) : null };
  }
}

class Live {
  constructor(page) {
    [this.page, this.paused, this.span, this.arrived] = [page, false, 10, 0];
    this.controls(page.bar);
    this.connect();
    setInterval(() => this.watch(), 500);
  }

  controls(bar) {
    this.button = element("button", { className: "play", id: "pause", title: word("live_freeze") });
    this.button.onclick = () => this.pause(!this.paused);
    this.spans = element("select", { id: "span", ariaLabel: word("span") }, ...[5, 10, 20, 60].map((s) =>
      element("option", { value: s, textContent: word("live_last", s), selected: s === 10 })));
    this.spans.onchange = () => { this.span = Number(this.spans.value); this.draw(); };
    const gauge = (id, label) => {
      const number = element("b", { id, textContent: "–" });
      bar.append(element("span", { className: "gauge" }, `${label} `, number));
      return number;
    };
    bar.append(this.button, this.spans);
    this.gauges = { time: gauge("time", word("live_time")), rate: gauge("rate", word("live_rate")), latency: gauge("latency", word("live_latency")), lost: gauge("lost", word("live_lost")) };
    this.state = bar.appendChild(element("span", { className: "state", id: "state" }));
    addEventListener("keydown", (event) => {
      if (event.key !== " " || /INPUT|SELECT|BUTTON/.test(event.target.tagName)) return;
      event.preventDefault();
      this.pause(!this.paused);
    });
    this.pause(false);
    this.tell(word("live_connecting"), "wait");
  }

  pause(on) {
    this.paused = on;
    this.button.textContent = word(on ? "live_continue" : "pause");
    this.button.setAttribute("aria-pressed", on);
  }

  tell(text, kind) {
    this.state.textContent = text;
    this.state.dataset.kind = kind;
  }

  connect() {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/frames${location.search}`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.read(JSON.parse(data)) : this.take(new Float32Array(data)));
    socket.onopen = () => { this.connected = true; };
    socket.onclose = () => {
      this.connected = false;
      this.tell(word("live_unconnected"), "bad");
      setTimeout(() => this.connect(), 1000);
    };
  }

  read(message) {
    learn(message.said);
    if (message.judgement) this.judge(message.judgement);
    else this.begin(message);
  }

  // The running verdict: its line below the header, its reasons and limbs in doubt on a click.
  judge({ overall, line, sentences, notices, limb_doubts, time_s }) {
    if (!this.judged) {
      this.judged = element("details", { id: "judgement" });
      document.querySelector("header").after(this.judged);
    }
    const limbs = limb_doubts.map((one) => element("li", { className: "limb" }, spoken(one.sentence)));
    this.judged.dataset.word = overall;
    this.judged.replaceChildren(element("summary", { title: word("live_judged", numeral(time_s, 1)) }, spoken(line)),
      element("ul", {}, ...[...sentences, ...notices].map((text) => element("li", {}, spoken(text))), ...limbs));
    this.judged.classList.toggle("bare", !this.judged.querySelector("li"));
  }

  begin(scene) {
    this.stream = new Stream(scene);
    this.page.title(scene.title);
    if (!this.view) {
      this.view = new BodyScene(this.page.pane, scene);
      this.page.legend(this.view);
      this.panel = new Panel(this.page.column, scene.quantities, null);
      this.panel.onChange = () => this.draw();
    } else if (JSON.stringify(scene.parts) !== JSON.stringify(this.scene.parts)) location.reload();
    this.scene = scene;
    this.tell(word("live_first"), "wait");
  }

  take(row) {
    this.arrived = performance.now();
    this.status = Object.fromEntries(this.scene.status.map((name, i) => [name, row[i]]));
    if (!this.paused) {
      this.stream.push(row);
      if (!this.drawing) this.drawing = requestAnimationFrame(() => { this.drawing = 0; this.draw(); });
    }
    this.watch();
  }

  watch() {
    if (!this.connected || !this.status || !this.arrived) return;
    const s = this.status;
    this.gauges.time.textContent = `${numeral(s.time_s, 1)} s`;
    this.gauges.rate.textContent = `${s.rate_hz.toFixed(0)} Hz`;
    this.gauges.latency.textContent = `${numeral(s.latency_ms, 1)} ms`;
    this.gauges.lost.textContent = s.lost.toFixed(0);
    this.gauges.lost.parentElement.classList.toggle("bad", s.lost > 0);
    const quiet = (performance.now() - this.arrived) / 1000;
    if (quiet > 1) this.tell(word("live_quiet", quiet.toFixed(0)), "bad");
    else if (this.paused) this.tell(word("live_paused"), "wait");
    else if (!s.tracked) this.tell(word("live_untracked"), "bad");
    else if (s.unexplained) this.tell(word("live_unexplained"), "bad");
    else this.tell(word("live_now"), "good");
  }

  draw() {
    if (!this.stream || !this.stream.rows.length) return;
    const rows = this.stream.rows, row = rows[rows.length - 1];
    this.view.show(row);
    this.panel.draw(this.stream, row, [row[0] - this.span, row[0]], null);
  }
}
