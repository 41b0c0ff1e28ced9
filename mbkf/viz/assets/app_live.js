// The live run on the page: a form for its stream and body, its own page while it goes on, and how it ended.
"use strict";

const SOURCE_WORDS = {
  lsl: "live_lsl", natnet: "live_natnet", qualisys: "live_qualisys", vicon: "live_vicon", xsens: "live_xsens", udp: "live_udp", file: "live_file",
};

const LIVE_AGAIN_MS = 500;

function liveSection(data, act) {
  const button = element("button", { type: "button", className: "live", onclick: () => act.open("live") }, `${word("live")} …`);
  button.dataset.key = "live";
  return element("section", {}, titled("live", "live", act), element("div", { className: "run" }, button, element("span", {}, word("live_hint"))));
}

async function askLive(path, options = {}) {
  const answer = await fetch(path, options).catch(() => null);
  if (answer === null) throw new Error(word("lost"));
  const said = await answer.json();
  if (!answer.ok) throw new Error(said.trouble);
  return said;
}

function streamText(one) {
  const points = one.markers === null ? word("live_unknown") : one.markers ? word("live_markers", one.markers) : word("live_points");
  const carries = [one.segments ? word("live_segments", one.segments) : one.sensors ? word("live_sensors", one.sensors) : points];
  if (one.rate_hz !== null) carries.push(word("live_hz", Math.round(one.rate_hz)));
  if (one.plates !== null) carries.push(word("live_plates", one.plates));
  return word("live_stream_of", one.name, word(SOURCE_WORDS[one.kind]), one.address, carries.join(", "));
}

class LiveDialog {
  // trial: the capture to rehearse with; null for any.
  constructor(session, act, trial = null) {
    Object.assign(this, { session, act, trial });
    this.told = element("span", { className: "told", role: "status" });
    this.stopper = element("button", { type: "button", className: "stop", hidden: true, onclick: () => this.stop() }, word("live_stop"));
    const close = element("button", { type: "button", onclick: () => this.dialog.close() }, word("close"));
    this.inside = element("div", { className: "inside" });
    this.dialog = element("dialog", { className: "live", ariaLabel: word("live"), onclose: () => this.leave() },
      element("div", { className: "bar" }, element("b", {}, `${word("live")} · ${session}`), this.told, this.stopper, close), this.inside);
  }

  async open() {
    this.dialog.opener = keyOf(document.activeElement);
    document.body.append(this.dialog);
    this.dialog.showModal();
    await this.begin();
  }

  // The run that goes on, or the form for a new one.
  async begin() {
    await this.trying(async () => {
      const offer = await askLive("live?" + query({ session: this.session }));
      if (!this.dialog.isConnected) return;
      if (offer.run && offer.run.goes_on) this.follow(offer.run);
      else this.form(offer);
    });
  }

  leave() {
    clearTimeout(this.timer);
    this.act.leave(this.dialog);
  }

  async trying(what) {
    try {
      await what();
    } catch (error) {
      this.tell(error.message, true);
    }
  }

  tell(text, bad = false) {
    if (this.told.textContent !== text) this.told.textContent = text;
    this.told.classList.toggle("bad", bad);
  }

  form(offer) {
    this.tell("");
    const select = (name, choices) => element("select", { name }, ...choices.map(([value, text]) => element("option", { value }, text)));
    const sources = Object.entries(SOURCE_WORDS).filter(([kind]) => kind !== "file" || offer.captures.length).map(([kind, name]) => [kind, word(name)]);
    const source = select("source", sources), captures = offer.captures.map(({ name, file, kind }) => [name, `${file} (${word(KIND_WORDS[kind])})`]), place = element("div", { className: "fields" });
    const bodies = offer.subject ? [["subject", word("live_subject")]] : [], standing = ["standing", word("live_standing")];
    const body = select("body", []), note = element("p", {});
    const record = element("input", { type: "checkbox", name: "record" }), recording = element("label", {}, record, word("live_record"));
    const weigh = () => {
      if (body.value === "subject") note.textContent = "";
      else if (source.value === "xsens") note.textContent = word("live_no_body");
      else note.textContent = offer.mass_kg === null ? word("live_weigh") : word("live_mass", offer.mass_kg);
    };
    const input = (name, value = "", type = "text") => element("input", { name, type, value, spellcheck: false });
    const local = (known) => field(word("live_local"), input("local", known.local || "127.0.0.1"));
    const there = (name, known, usual) => {
      const [host, port] = (known.place || "").split(":");
      return [field(word(name), input("host", host || "127.0.0.1")), field(word("live_its_port"), input("port", port || usual))];
    };
    const parts = {
      lsl: (known) => [field(word("live_stream"), input("stream", known.stream))],
      natnet: (known) => [field(word("live_server"), input("server", known.server || "127.0.0.1")), local(known),
        input("port", known.port, "hidden"), input("multicast", known.multicast, "hidden")],
      qualisys: (known) => there("live_qtm", known, "22222"),
      vicon: (known) => there("live_vicon_host", known, "801"),
      xsens: (known) => [field(word("live_port"), input("port", known.place || "9763")), local(known)],
      udp: (known) => [field(word("live_port"), input("port", known.place || "15100")), local(known)],
      file: () => [field(word("live_capture"), select("trial", captures))],
    };
    const fill = (known = {}) => {
      place.replaceChildren(...parts[source.value](known));
      recording.hidden = record.disabled = source.value === "xsens";
      const chosen = body.value, choices = source.value === "xsens" ? bodies : [...bodies, standing];
      body.replaceChildren(...choices.map(([value, text]) => element("option", { value }, text)));
      if (choices.some(([value]) => value === chosen)) body.value = chosen;
      weigh();
    };
    source.onchange = () => { this.tell(""); fill(); };
    const rehearsed = captures.some(([name]) => name === this.trial);
    const search = this.search((found) => {
      source.value = found.kind;
      fill({ place: found.place, ...found.options });
    }, () => !rehearsed && place.querySelector("input[name=stream]")?.value === "");
    body.onchange = weigh;
    const form = element("form", { className: "live" }, ...search, field(word("live_source"), source), place, field(word("live_body"), body), note, recording,
      element("p", {}, word("live_targets")), element("button", { className: "main" }, word("live_start")));
    form.onsubmit = (event) => {
      event.preventDefault();
      this.start(Object.fromEntries(new FormData(form)));
    };
    this.inside.replaceChildren(form);
    if (rehearsed) source.value = "file";
    fill();
    if (rehearsed) form.elements.trial.value = this.trial;
    source.focus();
  }

  // The streams of the network, looked for now and at the press of a button; pick takes the chosen one, and the first one
  // while untouched() is true.
  search(pick, untouched) {
    const choice = element("select", { className: "found" }), again = element("button", { type: "button" }, word("live_look")), said = element("p", { role: "status" });
    let streams = [];
    const look = () => this.trying(async () => {
      again.disabled = true;
      this.tell(word("live_looking"));
      try {
        ({ streams } = await askLive("live/streams"));
        if (!choice.isConnected) return;
        choice.replaceChildren(element("option", { value: -1 }, streams.length ? word("live_choose") : "–"),
          ...streams.map((one, k) => element("option", { value: k }, streamText(one))));
        said.textContent = streams.length ? "" : word("live_none");
        this.tell("");
        if (streams.length && untouched()) {
          choice.value = 0;
          pick(streams[0]);
        }
      } finally {
        again.disabled = false;
      }
    });
    choice.onchange = () => { if (streams[choice.value]) pick(streams[choice.value]); };
    again.onclick = look;
    queueMicrotask(look);
    return [field(word("live_found"), choice), again, said];
  }

  start(wanted) {
    return this.trying(async () => {
      const begun = await askLive("live?" + query({ session: this.session, do: "start" }), { method: "POST", body: JSON.stringify(wanted) });
      this.inside.replaceChildren();
      this.follow(begun.run);
    });
  }

  stop() {
    return this.trying(async () => {
      clearTimeout(this.timer);
      this.follow((await askLive("live?" + query({ session: this.session, do: "stop" }), { method: "POST" })).run);
    });
  }

  // What is told of a run that goes on, and its page once it has one; asked again until it ends.
  follow(run) {
    if (!this.dialog.isConnected) return;
    if (!run.goes_on) {
      this.end(run);
      return;
    }
    if (run.port !== null && !this.inside.querySelector("iframe")) {
      this.inside.replaceChildren(element("iframe", { src: "live/page?" + query({ language }), title: word("live") }));
    }
    this.stopper.hidden = false;
    this.stopper.disabled = run.state === "ending";
    const said = run.state === "ending" ? word("live_ending") : run.said || word("live_starting");
    this.tell(run.session === this.session ? said : word("live_goes_on", run.session, said));
    this.timer = setTimeout(() => this.trying(async () => this.follow((await askLive("live/state")).run)), LIVE_AGAIN_MS);
  }

  end(run) {
    this.stopper.hidden = true;
    const again = element("button", { type: "button", onclick: () => this.begin() }, word("live_another"));
    this.inside.replaceChildren(element("p", { className: "again" }, again));
    this.tell(run.state === "failed" ? word("live_failed", run.reason) : word("live_ended", run.name), run.state === "failed");
    again.focus();
    if (this.dialog.isConnected) refresh();
  }
}
