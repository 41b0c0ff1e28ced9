// Changing a marker set: a card for the chosen marker, choices by marker, and saving them by the server.
"use strict";

const REASONS = [["set_leave", "left out by hand"], ["set_not_known", "not known which marker this is"]]; // reasons as files hold them

class MarkerEdit extends MarkerSet {
  constructor(data) {
    super(data);
    this.choices = new Map();
    this.kept = {}; // the choices of the last save
    this.before = new Map(this.markers.map((marker) => [marker.name, { ...marker }]));
    this.landmarks = data.landmarks;
    this.controls();
    this.connect();
  }

  controls() {
    const bar = document.getElementById("bar");
    this.state = element("span", { className: "state", id: "state", textContent: word("set_nothing_changed") });
    this.state.setAttribute("role", "status");
    this.save = element("button", { type: "button", id: "save", className: "play", textContent: word("set_save", this.data.out) });
    this.done = element("button", { type: "button", id: "done", textContent: word("set_done") });
    this.save.onclick = () => this.keep();
    this.done.onclick = () => {
      if (this.unsaved && !confirm(word("set_unsaved"))) return;
      this.ended = true; // the server may be gone before it answers
      this.send({ do: "done" });
    };
    bar.append(this.state, this.save, this.done);
  }

  connect() {
    if (this.data.say) return;
    this.socket = new WebSocket(`ws://${location.host}/frames${location.search}`);
    this.socket.onmessage = ({ data }) => { if (data) this.take(JSON.parse(data)); };
    this.socket.onclose = () => {
      this.say(word(this.ended ? "set_closed" : "set_unconnected"), this.ended ? "good" : "bad");
      for (const button of [this.save, this.done]) button.disabled = true;
    };
  }

  // over: keep the own choices where somebody else has changed the same marker.
  keep(over = false) {
    this.sent = Object.fromEntries(this.choices);
    this.send({ do: "save", choices: this.sent, before: this.kept, over });
  }

  send(word) {
    if (this.data.say) {
      fetch(this.data.say, { method: "POST", body: JSON.stringify(word) }).then((answer) => answer.json()).then((said) => this.take(said), () => this.say(word("set_unconnected"), "bad"));
      return;
    }
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(word));
  }

  take({ trouble, saved, markers, done, differences }) {
    if (done && this.data.say) {
      this.say(word("set_closed"), "good");
      window.parent.postMessage("marker set done", location.origin);
    }
    if (differences && confirm(word("set_overtaken", differences.join(", ")))) {
      this.keep(true);
      return;
    }
    if (differences) trouble = word("set_other_kept", differences.join(", "));
    if (saved) this.kept = this.sent;
    if (trouble && !saved) {
      this.tell(trouble);
      this.say(word("set_not_saved"), "bad");
    }
    if (saved) {
      this.unsaved = false;
      this.tell(trouble || "");
      this.say(word("set_saved", markers), "good");
    }
  }

  say(text, kind) {
    this.state.textContent = text;
    this.state.dataset.kind = kind;
  }

  tell(text) { document.getElementById("trouble").textContent = text; }

  head() {
    if (this.choices && this.chosen) return this.card(this.chosen);
    this.shown = null;
    const said = [element("p", { className: "note", textContent: word("set_choose") })];
    if (this.data.trouble) said.push(element("p", { className: "note bad", textContent: word("set_misfit", spoken(this.data.trouble)) }));
    this.header.replaceChildren(...said);
  }

  // The card of a marker. The list of segments stays the same element, so that a person can type in it.
  card(marker) {
    if (!this.shown || this.shown.marker !== marker) {
      const [swatch, said, segments, landmarks] = [element("i", { className: "swatch" }), element("p"), element("select", { id: "segment" }), element("select", { id: "landmark" })];
      segments.append(element("option", { value: "", textContent: word("set_out_option") }));
      for (const { name, title } of this.data.segments) segments.append(element("option", { value: name, textContent: spoken(title) }));
      segments.onchange = () => (segments.value ? this.move(marker, { segment: segments.value }) : this.leave(marker, REASONS[0][1]));
      landmarks.onchange = () => this.move(marker, landmarks.value ? { landmark: landmarks.value } : { segment: marker.segment });
      const actions = element("div", { className: "actions" });
      this.shown = { marker, swatch, said, segments, landmarks, actions };
      this.header.replaceChildren(element("section", { id: "card" }, element("h2", {}, swatch, marker.name), said,
        element("label", {}, word("set_segment"), segments), element("label", {}, word("set_landmark"), landmarks), actions));
    }
    this.fill(this.shown);
  }

  fill({ marker, swatch, said, segments, landmarks, actions }) {
    swatch.style.setProperty("--own", this.colour(marker));
    said.textContent = this.told(marker);
    said.className = this.doubtful(marker) ? "doubtful" : "";
    segments.options[0].textContent = word(marker.ignored === UNKNOWN ? "set_unknown_option" : "set_out_option");
    if (segments.value !== marker.segment) segments.value = marker.segment;
    const near = this.near(marker).map(({ name, mm }) => element("option", { value: name, textContent: mm === null ? spoken(name.replaceAll("_", " ")) : word("set_away", spoken(name.replaceAll("_", " ")), mm) }));
    landmarks.replaceChildren(element("option", { value: "", textContent: word(marker.seen ? "set_as_captured" : "set_as_set") }), ...near);
    landmarks.value = marker.landmark;
    actions.replaceChildren(...this.actions(marker));
  }

  told(marker) {
    if (marker.ignored) return marker.ignored === UNKNOWN ? word("set_place_it") : word("set_is_out", spoken(marker.ignored));
    const off = marker.seen && marker.place ? word("set_off", Math.round(1000 * Math.hypot(...marker.at.map((x, k) => x - marker.place[k])))) : "";
    return this.title(marker).slice(marker.name.length + 2) + off;
  }

  // Landmarks of the marker's segment, the nearest first.
  near(marker) {
    const from = marker.at || marker.place;
    const away = ({ at }) => (from ? Math.round(1000 * Math.hypot(...at.map((x, k) => x - from[k]))) : null);
    return this.landmarks.filter(({ segment }) => !marker.segment || segment === marker.segment)
      .map((one) => ({ ...one, mm: away(one) })).sort((a, b) => a.mm - b.mm);
  }

  actions(marker) {
    const actions = [];
    const add = (text, act) => {
      const button = element("button", { type: "button", textContent: text });
      button.onclick = act;
      actions.push(button);
    };
    if (this.doubtful(marker)) add(word("set_right"), () => this.confirm(marker));
    for (const [name, odds] of marker.alternatives) {
      add(`${this.titles.get(name) || name} (${Math.round(100 * odds)} %)`, () => this.move(marker, { segment: name }));
    }
    for (const [text, reason] of REASONS) if (marker.ignored !== reason) add(word(text), () => this.leave(marker, reason));
    if (this.choices.has(marker.name)) add(word("set_before"), () => this.undo(marker));
    return actions;
  }

  move(marker, choice) {
    const landmark = choice.landmark ? this.landmarks.find(({ name }) => name === choice.landmark) : null;
    if (!landmark && !choice.segment) return this.refresh();
    if (!landmark && !marker.seen) {
      this.tell(word("set_needs_landmark", marker.name));
      return this.refresh();
    }
    this.tell("");
    Object.assign(marker, {
      segment: landmark ? landmark.segment : choice.segment, landmark: landmark ? landmark.name : "", ignored: "",
      kind: landmark ? "anatomical" : "technical", place: landmark ? landmark.at : marker.at, probability: 1, alternatives: [],
    });
    if (!marker.seen) marker.at = marker.place;
    this.labels.keep(marker);
    this.changed(marker, choice);
  }

  confirm(marker) {
    Object.assign(marker, { probability: 1, alternatives: [] });
    this.changed(marker, {});
  }

  leave(marker, reason) {
    Object.assign(marker, { segment: "", landmark: "", kind: "", ignored: reason, place: null, probability: 1, alternatives: [] });
    this.changed(marker, { ignored: reason });
  }

  undo(marker) {
    Object.assign(marker, this.before.get(marker.name));
    this.choices.delete(marker.name);
    this.after();
  }

  changed(marker, choice) {
    this.choices.set(marker.name, choice);
    this.after();
  }

  after() {
    this.unsaved = true;
    this.say(word("set_changed"), "");
    this.refresh();
  }
}
