// The live run on the page: a form for its stream and body, its own page while it goes on, and how it ended.
"use strict";

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
    const sources = [["lsl", word("live_lsl")], ["natnet", word("live_natnet")]];
    if (offer.captures.length) sources.push(["file", word("live_file")]);
    const source = select("source", sources), captures = offer.captures.map(({ name, file, kind }) => [name, `${file} (${word(KIND_WORDS[kind])})`]), place = element("div", { className: "fields" });
    const bodies = [["standing", word("live_standing")]];
    if (offer.subject) bodies.unshift(["subject", word("live_subject")]);
    const body = select("body", bodies), note = element("p", {});
    const weigh = () => { note.textContent = body.value === "subject" ? "" : offer.mass_kg === null ? word("live_weigh") : word("live_mass", offer.mass_kg); };
    const parts = { lsl: () => this.streams(), natnet: () => this.addresses(), file: () => [field(word("live_capture"), select("trial", captures))] };
    source.onchange = () => { this.tell(""); place.replaceChildren(...parts[source.value]()); };
    body.onchange = weigh;
    const form = element("form", { className: "live" }, field(word("live_source"), source), place, field(word("live_body"), body), note,
      element("p", {}, word("live_targets")), element("button", { className: "main" }, word("live_start")));
    form.onsubmit = (event) => {
      event.preventDefault();
      this.start(Object.fromEntries(new FormData(form)));
    };
    this.inside.replaceChildren(form);
    const rehearsed = captures.some(([name]) => name === this.trial);
    if (rehearsed) source.value = "file";
    source.onchange();
    if (rehearsed) form.elements.trial.value = this.trial;
    weigh();
    source.focus();
  }

  streams() {
    const choice = element("select", { name: "stream" }), again = element("button", { type: "button" }, word("live_look"));
    const look = () => this.trying(async () => {
      again.disabled = true;
      this.tell(word("live_looking"));
      try {
        const { streams } = await askLive("live/streams");
        if (!choice.isConnected) return;
        choice.replaceChildren(...streams.map((one) => element("option", { value: one.name }, word("live_stream_of", one.name, one.host, Math.round(one.rate_hz)))));
        this.tell(streams.length ? "" : word("live_none"));
      } finally {
        again.disabled = false;
      }
    });
    again.onclick = look;
    queueMicrotask(look);
    return [field(word("live_stream"), choice), again];
  }

  addresses() {
    const input = (name) => element("input", { name, type: "text", value: "127.0.0.1", spellcheck: false });
    return [field(word("live_server"), input("server")), field(word("live_local"), input("local"))];
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
