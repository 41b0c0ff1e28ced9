// The strip under the time slider: contacts, strikes and toe-offs of both feet, to be moved, added and deleted.
"use strict";

const FEET = ["right", "left"], KINDS = ["strike", "off"];
const SIGNS = { strike: { hand: "▼", found: "▽" }, off: { hand: "▲", found: "△" } };
const LEAP = 10; // frames that Shift and an arrow go

class Strip {
  // place: the element to fill; events: FootEvents; frame: seconds from frame to frame; time(), seek(time): of the player.
  constructor(place, slider, events, contacts, frame, time, seek) {
    Object.assign(this, { place, events, frame, time, seek, chosen: null, buttons: new Map(), tracks: {}, cursors: [] });
    place.setAttribute("aria-label", word("strip"));
    this.said = element("span", { className: "said", role: "status" });
    place.append(this.said, slider);
    FEET.forEach((side, load) => this.lane(side, contacts[load]));
    this.tools();
    addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || /INPUT|TEXTAREA/.test(event.target.tagName) && event.target.type === "number") return;
      event.preventDefault();
      event.shiftKey ? events.redo() : events.undo();
    });
    this.draw();
  }

  say(text, bad = false) {
    this.said.textContent = this.said.title = text;
    this.said.className = bad ? "said bad" : "said";
  }

  at(time) {
    const [first, last] = this.events.span;
    return `${(100 * (time - first)) / Math.max(last - first, 1e-9)}%`;
  }

  timeAt(track, clientX) {
    const box = track.getBoundingClientRect(), [first, last] = this.events.span;
    const time = first + Math.min(1, Math.max(0, (clientX - box.left) / box.width)) * (last - first);
    return first + Math.round((time - first) / this.frame) * this.frame;
  }

  lane(side, contacts) {
    const adders = KINDS.map((kind) => {
      const add = element("button", { type: "button", title: word("add_title"), onclick: () => this.add(side, kind, this.time()) }, `+ ${SIGNS[kind].hand} ${word(kind)}`);
      add.setAttribute("aria-label", word("add", word(`${side}_${kind}`)));
      return add;
    });
    const inner = element("div", { className: "inner" }), track = element("div", { className: `track ${side}` }, inner);
    for (const { from, to, measured } of contacts) {
      const bar = element("div", { className: `contact ${measured ? "measured" : "estimated"}`, title: word(measured ? "contact_measured" : "contact_estimated") });
      bar.style.left = this.at(from);
      bar.style.width = `calc(${this.at(to)} - ${this.at(from)})`;
      inner.append(bar);
    }
    track.ondblclick = (event) => {
      if (event.target.classList.contains("event")) return;
      const box = track.getBoundingClientRect();
      this.add(side, event.clientY < box.top + box.height / 2 ? "strike" : "off", this.timeAt(inner, event.clientX));
    };
    const cursor = element("div", { className: "now" });
    inner.append(cursor);
    this.cursors.push(cursor);
    this.tracks[side] = inner;
    this.place.append(element("div", { className: `foot-name ${side}` }, element("b", {}, word(side)), ...adders), track);
  }

  tools() {
    const button = (name, act) => element("button", { type: "button", onclick: act }, word(name));
    this.delete = button("delete", () => this.remove(this.chosen));
    this.undo = button("undo", () => this.events.undo());
    this.redo = button("redo", () => this.events.redo());
    this.forget = button("forget", () => this.events.forget());
    const sign = (text, name) => element("span", {}, element("i", {}, text), " " + word(name));
    const bar = (kind) => element("span", {}, element("span", { className: `contact bar ${kind}` }), " " + word(`contact_${kind}`));
    const key = element("span", { className: "key" }, sign("▼▲", "by_hand"), sign("▽△", "found"), bar("measured"), bar("estimated"));
    const keys = element("details", {}, element("summary", {}, word("keys")), element("p", { className: "hint" }, word("hint")));
    this.order = element("p", { className: "order", role: "status" });
    this.place.append(element("div", { className: "tools" }, this.delete, this.undo, this.redo, this.forget, key, keys), this.order);
  }

  add(side, kind, time) {
    const key = this.events.add(side, kind, time);
    this.buttons.get(key).focus();
  }

  remove(key) {
    const event = this.events.get(key);
    if (!event) return;
    const lane = this.events.of(event.side), k = lane.findIndex((one) => one.key === key), next = lane[k + 1] || lane[k - 1];
    this.chosen = null;
    this.events.remove(key);
    const to = next && this.buttons.get(next.key);
    (to || this.place.querySelector(`.foot-name.${event.side} button`)).focus();
  }

  // Shows the events as they are now; buttons that stay keep the focus.
  draw() {
    const shown = new Set(this.events.shown.map((one) => one.key));
    for (const [key, button] of this.buttons) {
      if (shown.has(key)) continue;
      button.remove();
      this.buttons.delete(key);
    }
    if (!shown.has(this.chosen)) this.chosen = null;
    for (const side of FEET) {
      const lane = this.events.of(side), stop = lane.find((one) => one.key === this.chosen) || lane[0];
      for (const one of lane) this.mark(one, one === stop);
    }
    this.place.querySelectorAll(".was").forEach((mark) => mark.remove());
    if (this.events.byHand) this.events.found.forEach((one) => this.was(one));
    this.delete.disabled = this.chosen === null;
    this.undo.disabled = !this.events.past.length;
    this.redo.disabled = !this.events.future.length;
    this.forget.disabled = !this.events.byHand;
    const faults = this.events.outOfOrder(), [first] = faults, time = (one) => one.time_s.toFixed(2);
    const text = first ? word("out_of_order", word(`${first.side}_${first.kind}`), time(first.from), time(first.to), word(`${first.side}_${first.kind === "off" ? "strike" : "off"}`), faults.length) : "";
    if (this.order.textContent !== text) this.order.textContent = text;
  }

  was({ side, kind, time_s }) {
    const mark = element("div", { className: `was ${kind}` });
    mark.style.left = this.at(time_s);
    this.tracks[side].prepend(mark);
  }

  mark({ side, kind, time_s, key }, stop) {
    const button = this.buttons.get(key) || this.button(side, kind, key), how = this.events.byHand ? "hand" : "found";
    button.className = `event ${kind} ${how}`;
    button.textContent = SIGNS[kind][how];
    button.style.left = this.at(time_s);
    button.tabIndex = stop ? 0 : -1;
    button.dataset.chosen = String(key === this.chosen);
    const told = `${numeral(time_s, 3)} s, ${word(how === "hand" ? "by_hand" : "found")}`;
    button.title = `${word(`${side}_${kind}`)}, ${told}`;
    const values = { valuemin: this.events.span[0], valuemax: this.events.span[1], valuenow: time_s, valuetext: told };
    for (const [name, value] of Object.entries(values)) button.setAttribute(`aria-${name}`, value);
  }

  button(side, kind, key) {
    const button = element("button", { type: "button" });
    button.setAttribute("role", "slider");
    button.setAttribute("aria-label", word(`${side}_${kind}`));
    button.onfocus = () => this.choose(key);
    button.onkeydown = (event) => this.pressed(event, key);
    this.draggable(button, side, key);
    this.tracks[side].append(button);
    this.buttons.set(key, button);
    return button;
  }

  choose(key) {
    this.chosen = key;
    this.seek(this.events.get(key).time_s);
    this.draw();
  }

  draggable(button, side, key) {
    let held = false;
    button.onpointerdown = (event) => { if (event.button === 0) { held = true; button.setPointerCapture(event.pointerId); button.focus(); } };
    button.onpointermove = (event) => {
      if (!held || Math.abs(event.movementX) + Math.abs(event.movementY) === 0) return;
      if (this.events.moved && this.events.moved.key === key) this.events.moved.at = performance.now(); // one drag, one undo
      this.to(key, this.timeAt(this.tracks[side], event.clientX));
    };
    button.onpointerup = button.onpointercancel = () => { if (held) this.events.moved = null; held = false; };
  }

  to(key, time) {
    this.events.move(key, time);
    this.seek(this.events.get(key).time_s);
  }

  pressed(event, key) {
    const one = this.events.get(key), step = this.frame * (event.shiftKey ? LEAP : 1), lane = this.events.of(one.side);
    const beside = (by) => { const next = lane[lane.findIndex((o) => o.key === key) + by]; if (next) this.buttons.get(next.key).focus(); };
    const acts = {
      ArrowLeft: () => this.to(key, one.time_s - step), ArrowRight: () => this.to(key, one.time_s + step),
      ArrowUp: () => beside(-1), ArrowDown: () => beside(1),
      Delete: () => this.remove(key), Backspace: () => this.remove(key),
    };
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation(); // the player's own arrows
    acts[event.key]();
  }

  // The present time.
  cursor(time) {
    for (const cursor of this.cursors) cursor.style.left = this.at(time);
  }
}
