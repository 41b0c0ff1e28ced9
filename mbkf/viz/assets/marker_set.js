// The page of a marker set: the body in the colours of its segments, the markers on it, and a list by segment.
"use strict";

const NEARER = 0.9, UNKNOWN = "not in the set"; // the server's word for such a marker

class MarkerSet {
  constructor(data) {
    [this.data, this.markers, this.chosen] = [data, data.markers, null];
    this.colours = new Map(data.segments.map(({ name, colour }) => [name, colour]));
    this.titles = new Map(data.segments.map(({ name, title }) => [name, spoken(title)]));
    this.column = document.getElementById("column");
    [this.header, this.listing] = [element("div", { id: "head" }), element("div")];
    this.column.append(this.header, this.listing);
    document.getElementById("trial").textContent = data.title;
    document.title = `${data.title} · mbkf`;
    this.view = new BodyScene(document.getElementById("scene"), data.scene);
    this.paintBody();
    this.view.show(data.row.map((value) => (value === null ? NaN : value)));
    this.look("front");
    this.labels = new MarkerLabels(this.view, this.markers, this);
    this.buttons();
    this.list();
    document.addEventListener("keydown", (event) => this.key(event));
  }

  paintBody() {
    const white = new this.view.THREE.Color(0xffffff);
    this.view.segments.forEach((group, k) => {
      const colour = new this.view.THREE.Color(this.data.segments[k].colour).lerp(white, 0.52);
      for (const mesh of group.children) mesh.material.color.copy(colour);
    });
  }

  // As near as the whole person fits.
  look(from) {
    this.view.look(from);
    const { camera, controls } = this.view.viewer;
    camera.position.sub(controls.target).multiplyScalar(NEARER).add(controls.target);
    controls.update();
    this.view.viewer.set_dirty();
  }

  colour(marker) { return this.colours.get(marker.segment) || "#6b7785"; }

  classes(marker) {
    return [
      this.doubtful(marker) ? "doubtful" : "", marker.kind === "computed" ? "computed" : "", marker.ignored === UNKNOWN ? "unknown" : marker.ignored ? "ignored" : "",
      this.data.captured && !marker.seen ? "absent" : "",
    ].filter(Boolean);
  }

  doubtful(marker) { return !marker.ignored && marker.probability < this.data.sure; }

  // What is said of a marker where its name alone is not enough.
  title(marker) {
    if (marker.ignored) return `${marker.name}: ${spoken(marker.ignored)}`;
    const words = [`${marker.name}: ${this.titles.get(marker.segment)}`];
    if (marker.landmark) words.push(spoken(marker.landmark.replaceAll("_", " ")));
    words.push(spoken(marker.kind));
    if (this.doubtful(marker)) words.push(word("set_sure", Math.round(100 * marker.probability)) + this.others(marker));
    if (this.data.captured && !marker.seen) words.push(word("set_absent"));
    return words.join(", ");
  }

  others(marker) {
    return marker.alternatives.map(([name, odds]) => word("set_or", this.titles.get(name) || name, Math.round(100 * odds))).join("");
  }

  isChosen(marker) { return this.chosen === marker; }

  choose(marker) {
    this.chosen = this.chosen === marker ? null : marker;
    this.refresh();
  }

  refresh() {
    this.labels.again();
    this.list();
  }

  buttons() {
    const views = document.getElementById("views");
    for (const from of ["oblique", "front", "right", "left", "back"]) {
      const button = element("button", { type: "button", textContent: word(`from_${from}`) });
      button.onclick = () => this.look(from);
      views.append(button);
    }
    const toggle = (text, act) => {
      const box = element("input", { type: "checkbox", checked: true });
      box.onchange = () => { act(box.checked); this.labels.again(); };
      views.append(element("label", {}, box, text));
    };
    toggle(word("set_names"), (on) => { this.labels.named = on; });
    toggle(word("set_body"), (on) => { this.labels.body = on; this.view.toggle("body", on); });
  }

  // The list, segment by segment, and what is left out below it.
  list() {
    const own = this.markers.filter((marker) => !marker.ignored), doubts = own.filter((marker) => this.doubtful(marker));
    const computed = own.filter((marker) => marker.kind === "computed").length, held = this.column.scrollTop;
    const count = [word("set_markers", own.length - computed)];
    if (computed) count.push(word("set_computed_count", computed));
    const unknown = this.markers.filter((marker) => marker.ignored === UNKNOWN);
    if (unknown.length) count.push(word("set_unknown_count", unknown.length));
    if (doubts.length) count.push(word("set_doubt_count", doubts.length));
    document.getElementById("count").textContent = count.join(", ");
    const focus = document.activeElement && document.activeElement.dataset ? document.activeElement.dataset.item : undefined;
    const parts = unknown.length ? [this.part(word("set_unknown"), "#fff", unknown)] : [];
    for (const { name, title, colour } of this.data.segments) {
      const here = own.filter((marker) => marker.segment === name);
      if (here.length || !this.data.captured) parts.push(this.part(spoken(title), colour, here));
    }
    const out = this.markers.filter((marker) => marker.ignored && marker.ignored !== UNKNOWN);
    if (out.length) parts.push(this.part(word("set_left_out"), "#b8c2cc", out));
    parts.push(this.legend(doubts.length, computed, out.length, unknown.length));
    this.head();
    this.listing.replaceChildren(...parts);
    this.column.scrollTop = held;
    if (focus !== undefined) this.focusItem(focus);
  }

  focusItem(name) {
    const found = [...this.column.querySelectorAll(".item")].find((item) => item.dataset.item === name);
    if (found) found.focus({ preventScroll: true });
  }

  head() {
    if (this.data.source) this.header.replaceChildren(element("p", { className: "note", textContent: word("set_from", spoken(this.data.source)) }));
  }

  part(title, colour, markers) {
    const part = element("section", { className: "part" }), head = element("h2", {}, element("i"), title, element("span", { textContent: markers.length || word("set_none") }));
    part.style.setProperty("--own", colour);
    part.append(head, element("ul", {}, ...markers.map((marker) => element("li", {}, this.item(marker)))));
    return part;
  }

  item(marker) {
    const item = element("button", { type: "button", textContent: marker.name, title: this.title(marker) });
    item.className = ["item", ...this.classes(marker), this.isChosen(marker) ? "chosen" : ""].join(" ");
    item.dataset.item = marker.name;
    item.dataset.segment = marker.segment;
    item.style.setProperty("--own", this.colour(marker));
    if (this.doubtful(marker)) item.append(element("small", { textContent: `${Math.round(100 * marker.probability)} %${this.others(marker)}` }));
    if (marker.ignored && marker.ignored !== UNKNOWN) item.append(element("small", { textContent: spoken(marker.ignored) }));
    item.setAttribute("aria-pressed", this.isChosen(marker));
    item.onclick = () => this.choose(marker);
    return item;
  }

  legend(doubts, computed, out, unknown) {
    const key = element("p", { className: "note key" });
    const add = (kind, text) => {
      const sign = element("i", { className: `dot ${kind}` });
      sign.style.cssText = "position:static;margin:0 4px;--own:#6b7785";
      key.append(element("span", {}, sign, text));
    };
    add("", word(this.data.captured ? "set_measured" : "set_coloured"));
    if (doubts) add("doubtful", word("set_doubtful", Math.round(100 * this.data.sure)));
    if (computed) add("computed", word("set_computed"));
    if (unknown) add("unknown", word("set_unknown"));
    if (out && this.data.captured) add("ignored", word("set_left_out"));
    if (this.markers.some((marker) => this.data.captured && !marker.seen && !marker.ignored)) add("absent", word("set_absent"));
    if (this.data.captured) key.append(element("span", { textContent: word("set_line") }));
    return key;
  }

  // The arrows walk through the list.
  key(event) {
    if (event.key === "Escape" && this.chosen) return this.choose(this.chosen);
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
    if (!step || !event.target.classList || !event.target.classList.contains("item")) return;
    event.preventDefault();
    const items = [...this.column.querySelectorAll(".item")], next = items[items.indexOf(event.target) + step];
    if (next) next.focus();
  }
}

function begin() {
  const data = JSON.parse(document.getElementById("set").textContent);
  document.documentElement.lang = language;
  learn(data.said);
  window.mbkf = typeof MarkerEdit === "undefined" ? new MarkerSet(data) : new MarkerEdit(data);
}

addEventListener("error", (error) => {
  document.getElementById("trouble").textContent = word("went_wrong", error.message);
});
addEventListener("DOMContentLoaded", begin);
