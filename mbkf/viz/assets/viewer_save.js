// Events go to the server soon after they change, one request at a time; what was not taken is said and kept.
"use strict";

const SAVE_MS = 400, LONGEST_PARTING = 60000; // letters that a browser sends for a page that is closed

class Saving {
  // address: where to; known: {events, version} in the file; say(text, bad): tells how it went; take(events): the
  // person prefers the events that somebody else has set.
  constructor(address, known, say, take) {
    Object.assign(this, { address, known, say, take, waiting: null, timer: 0, busy: false });
    addEventListener("pagehide", () => { if (this.waiting) this.part(); });
  }

  part() {
    const events = this.waiting(), whole = this.body(events);
    this.post(whole.length < LONGEST_PARTING ? whole : JSON.stringify({ events }), { keepalive: true });
  }

  // events(): those to send, asked for when they are sent.
  soon(events) {
    this.waiting = events;
    this.say(word("saving"));
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), SAVE_MS);
  }

  body(events) {
    return JSON.stringify({ base: this.known.events, events });
  }

  post(body, options = {}) {
    return fetch(this.address, { method: "POST", headers: { "If-Match": `"${this.known.version}"` }, body, ...options });
  }

  async now() {
    if (this.busy || !this.waiting) return;
    const events = this.waiting;
    [this.busy, this.waiting] = [true, null];
    try {
      const answer = await this.post(this.body(events())), said = await answer.json();
      if (!answer.ok && !said.differences) throw new Error(said.trouble);
      this.known = { events: said.events, version: said.version };
      if (said.differences) this.differ(said, events);
      else if (!this.waiting) this.say(said.cycles ? word("saved", ...said.cycles) : word("saved_later"));
    } catch (error) {
      this.waiting = this.waiting || events;
      this.say(word("not_saved", error instanceof TypeError ? word("lost") : error.message), true);
      this.busy = false;
      return;
    }
    this.busy = false;
    if (this.waiting) this.now();
  }

  // Somebody else has set other events since this page loaded its own.
  differ(said, events) {
    const count = (list) => (list === null ? word("found") : list.length);
    const mine = this.waiting || events;
    if (confirm(word("overtaken", count(said.events), count(mine())))) this.waiting = mine;
    else {
      this.waiting = null;
      this.take(said.events);
      this.say(said.cycles ? word("saved", ...said.cycles) : word("saved_later"));
    }
  }
}
