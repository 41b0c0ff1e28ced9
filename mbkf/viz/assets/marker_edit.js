// Changing a marker set: a card for the chosen marker, choices by marker, and saving them by the server.
"use strict";

const REASONS = [["Leave out", "left out by hand"], ["Not known", "not known which marker this is"]];

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
    this.state = element("span", { className: "state", id: "state", textContent: "nothing changed" });
    this.state.setAttribute("role", "status");
    this.save = element("button", { type: "button", id: "save", className: "play", textContent: `Save ${this.data.out}` });
    this.done = element("button", { type: "button", id: "done", textContent: "Done" });
    this.save.onclick = () => this.keep();
    this.done.onclick = () => {
      if (this.unsaved && !confirm("There are changes that are not saved. End all the same?")) return;
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
      this.say(this.ended ? "done; this page can be closed" : "not connected: is mbkf still running?", this.ended ? "good" : "bad");
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
      fetch(this.data.say, { method: "POST", body: JSON.stringify(word) }).then((answer) => answer.json()).then((said) => this.take(said), () => this.say("not connected: is mbkf still running?", "bad"));
      return;
    }
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(word));
  }

  take({ trouble, saved, markers, done, differences }) {
    if (done && this.data.say) {
      this.say("done; this page can be closed", "good");
      window.parent.postMessage("marker set done", location.origin);
    }
    if (differences && confirm(`Somebody else has changed ${differences.join(", ")} meanwhile. OK keeps your choice, Cancel the other one.`)) {
      this.keep(true);
      return;
    }
    if (differences) trouble = `The other choice for ${differences.join(", ")} is kept; open this page again to see it.`;
    if (saved) this.kept = this.sent;
    if (trouble && !saved) {
      this.tell(trouble);
      this.say("not saved", "bad");
    }
    if (saved) {
      this.unsaved = false;
      this.tell(trouble || "");
      this.say(`saved: ${markers} markers`, "good");
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
    const said = [element("p", { className: "note", textContent: "Choose a marker, on the body or below, to move it or leave it out." })];
    if (this.data.trouble) said.push(element("p", { className: "note bad", textContent: `The set does not fit this capture yet, so the body is laid beside it roughly: ${this.data.trouble}` }));
    this.header.replaceChildren(...said);
  }

  // The card of a marker. The list of segments stays the same element, so that a person can type in it.
  card(marker) {
    if (!this.shown || this.shown.marker !== marker) {
      const [swatch, said, segments, landmarks] = [element("i", { className: "swatch" }), element("p"), element("select", { id: "segment" }), element("select", { id: "landmark" })];
      segments.append(element("option", { value: "", textContent: "(left out)" }));
      for (const { name, title } of this.data.segments) segments.append(element("option", { value: name, textContent: title }));
      segments.onchange = () => (segments.value ? this.move(marker, { segment: segments.value }) : this.leave(marker, REASONS[0][1]));
      landmarks.onchange = () => this.move(marker, landmarks.value ? { landmark: landmarks.value } : { segment: marker.segment });
      const actions = element("div", { className: "actions" });
      this.shown = { marker, swatch, said, segments, landmarks, actions };
      this.header.replaceChildren(element("section", { id: "card" }, element("h2", {}, swatch, marker.name), said,
        element("label", {}, "Segment", segments), element("label", {}, "Landmark", landmarks), actions));
    }
    this.fill(this.shown);
  }

  fill({ marker, swatch, said, segments, landmarks, actions }) {
    swatch.style.setProperty("--own", this.colour(marker));
    said.textContent = this.told(marker);
    said.className = this.doubtful(marker) ? "doubtful" : "";
    segments.options[0].textContent = marker.ignored === UNKNOWN ? "(not in the set)" : "(left out)";
    if (segments.value !== marker.segment) segments.value = marker.segment;
    const near = this.near(marker).map(({ name, mm }) => element("option", { value: name, textContent: name.replaceAll("_", " ") + (mm === null ? "" : `, ${mm} mm away`) }));
    landmarks.replaceChildren(element("option", { value: "", textContent: marker.seen ? "(where the capture shows it)" : "(where the set has it)" }), ...near);
    landmarks.value = marker.landmark;
    actions.replaceChildren(...this.actions(marker));
  }

  told(marker) {
    if (marker.ignored) return marker.ignored === UNKNOWN ? "Not in the set: choose what it is on, or leave it out." : `Left out: ${marker.ignored}`;
    const off = marker.seen && marker.place ? `, ${Math.round(1000 * Math.hypot(...marker.at.map((x, k) => x - marker.place[k])))} mm from where the set has it` : "";
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
    if (this.doubtful(marker)) add("It is right", () => this.confirm(marker));
    for (const [name, odds] of marker.alternatives) {
      add(`${this.titles.get(name) || name} (${Math.round(100 * odds)} %)`, () => this.move(marker, { segment: name }));
    }
    for (const [text, reason] of REASONS) if (marker.ignored !== reason) add(text, () => this.leave(marker, reason));
    if (this.choices.has(marker.name)) add("As before", () => this.undo(marker));
    return actions;
  }

  move(marker, choice) {
    const landmark = choice.landmark ? this.landmarks.find(({ name }) => name === choice.landmark) : null;
    if (!landmark && !choice.segment) return this.refresh();
    if (!landmark && !marker.seen) {
      this.tell(`The capture does not show ${marker.name}: choose a landmark for it, or leave it out.`);
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
    this.say("changed, not saved", "");
    this.refresh();
  }
}
