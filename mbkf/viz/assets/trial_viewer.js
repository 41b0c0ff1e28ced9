// The trial viewer: the player with its curves, the strip of events, where loads press, and another trial beside it.
"use strict";

class TrialViewer {
  constructor(player, page, trial) {
    Object.assign(this, { player, trial, ghost: null, asked: 0 });
    const { scene, found, events, version, frame_s, span_s, verdict } = page;
    document.documentElement.lang = language;
    const shown = document.getElementById("verdict");
    shown.textContent = verdict.line;
    shown.title = verdict.reasons.join("\n");
    shown.dataset.word = verdict.word;
    this.events = new FootEvents(found, events, span_s);
    this.pressure = new PressureMarks(player.view, scene.loads);
    this.pressure.legend(document.getElementById("legend"));
    const contacts = FEET.map((_, load) => this.inTime(contactsOf(player.recording, scene.parts, load)));
    this.strip = new Strip(document.getElementById("strip"), player.slider, this.events, contacts, frame_s,
      () => player.recording.times[player.frame], (time) => player.seek(time));
    const address = "events?" + new URLSearchParams({ session: trial.session, trial: trial.trial });
    const say = (text, bad) => this.strip.say(text, bad), count = (list) => (list === null ? word("found") : list.length);
    this.saving = new Saving(address, "events", { events, version }, {
      say, take: (theirs) => this.replace(theirs), saved: ({ cycles }) => (cycles ? word("saved", ...cycles) : word("saved_later")),
      overtaken: (theirs, mine) => word("overtaken", count(theirs), count(mine)),
    });
    this.events.onChange = () => this.changed();
    this.video = new TrialVideo(document.getElementById("film"), trial, player, say);
    this.others();
    player.panel.other = (q) => (this.ghost ? this.ghost.series(q) : null);
    player.onDraw = (row, time) => this.show(row, time);
    this.marks();
    player.draw();
  }

  // Frames as times.
  inTime(contacts) {
    const { times } = this.player.recording;
    return contacts.map(({ from, to, measured }) => ({ from: times[from], to: times[to], measured }));
  }

  show(row, time) {
    this.pressure.show(row);
    this.strip.cursor(time);
    if (this.ghost) this.ghost.show(time);
  }

  changed() {
    this.redraw();
    this.saving.soon(() => this.events.plain());
  }

  redraw() {
    this.strip.draw();
    this.marks();
    this.align();
    this.player.draw();
  }

  // Events that somebody else has set take the place of the own ones; undo brings these back.
  replace(theirs) {
    this.events.put(theirs);
    this.redraw();
  }

  marks() {
    const colours = { right: COLOURS.r, left: COLOURS.l };
    this.player.panel.marks = this.events.shown.map(({ side, kind, time_s }) => ({ time: time_s, colour: colours[side], dashed: kind === "off" }));
  }

  others() {
    const { others } = this.trial;
    this.chosen = element("select", { id: "ghost", onchange: () => this.lay() }, element("option", { value: "", textContent: word(others.length ? "no_ghost" : "no_others") }),
      ...others.map((name) => element("option", { value: name, textContent: name })));
    this.chosen.disabled = !others.length;
    this.mode = element("select", { id: "alignment", disabled: true, onchange: () => { this.align(); this.player.draw(); } },
      ...["cycle", "time"].map((mode) => element("option", { value: mode, textContent: word(`by_${mode}`) })));
    this.mode.setAttribute("aria-label", word("alignment"));
    const sign = element("i", { textContent: "┅" });
    sign.style.color = COLOURS.other;
    this.player.clock.parentElement.append(element("span", { id: "other" }, sign, element("label", { htmlFor: "ghost" }, word("ghost")), this.chosen, this.mode));
  }

  // Fetches the chosen trial and draws it; the last one chosen wins.
  async lay() {
    const name = this.chosen.value, asked = ++this.asked;
    if (this.ghost) this.ghost.remove();
    this.ghost = null;
    this.mode.disabled = !name;
    if (name) {
      try {
        const answer = await fetch("recording?" + new URLSearchParams({ session: this.trial.session, trial: name, language })), said = await answer.json();
        if (!answer.ok) throw new Error(said.trouble);
        const ghost = await Ghost.of(this.player.view, this.player.recording, said);
        if (asked !== this.asked) return ghost.remove();
        this.ghost = ghost;
        this.align();
      } catch (error) {
        this.strip.say(error instanceof TypeError ? word("lost") : error.message, true);
      }
    }
    this.player.draw();
  }

  align() {
    if (this.ghost && !this.ghost.align(this.mode.value, this.events.shown)) this.strip.say(word("no_cycles"), true);
  }
}

started.then(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  window.viewer = new TrialViewer(window.mbkf, read("recording"), read("viewer"));
}).catch(trouble);
