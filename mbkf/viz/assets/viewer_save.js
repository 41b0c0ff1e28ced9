// Statements on a trial go to the server soon after they change, one request at a time; what was not taken is said and kept.
"use strict";

const SAVE_MS = 400, LONGEST_PARTING = 60000; // letters that a browser sends for a page that is closed

class Saving {
  // address: where to; field: "events" or "video"; known: that field and its version in the file; say(text, bad): tells
  // how it went; take(theirs): the person prefers those of somebody else; saved(reply), overtaken(theirs, mine): texts.
  constructor(address, field, known, { say, take, saved, overtaken }) {
    Object.assign(this, { address, field, known, say, take, saved, overtaken, waiting: null, timer: 0, busy: false });
    addEventListener("pagehide", () => { if (this.waiting) this.part(); });
  }

  part() {
    const mine = this.waiting(), whole = this.body(mine);
    this.post(whole.length < LONGEST_PARTING ? whole : JSON.stringify({ [this.field]: mine }), { keepalive: true });
  }

  // mine(): those to send, asked for when they are sent.
  soon(mine) {
    this.waiting = mine;
    this.say(word("saving"));
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), SAVE_MS);
  }

  body(mine) {
    return JSON.stringify({ base: this.known[this.field], [this.field]: mine });
  }

  post(body, options = {}) {
    return fetch(this.address, { method: "POST", headers: { "If-Match": `"${this.known.version}"` }, body, ...options });
  }

  async now() {
    if (this.busy || !this.waiting) return;
    const mine = this.waiting;
    [this.busy, this.waiting] = [true, null];
    try {
      const answer = await this.post(this.body(mine())), said = await answer.json();
      if (!answer.ok && !said.differences) throw new Error(said.trouble);
      this.known = { [this.field]: said[this.field], version: said.version };
      if (said.differences) this.differ(said, mine);
      else if (!this.waiting) this.say(this.saved(said));
    } catch (error) {
      this.waiting = this.waiting || mine;
      this.say(word("not_saved", error instanceof TypeError ? word("lost") : error.message), true);
      this.busy = false;
      return;
    }
    this.busy = false;
    if (this.waiting) this.now();
  }

  // Somebody else has set others since this page loaded its own.
  differ(said, sent) {
    const theirs = said[this.field], mine = this.waiting || sent;
    if (confirm(this.overtaken(theirs, mine()))) this.waiting = mine;
    else {
      this.waiting = null;
      this.take(theirs);
      this.say(this.saved(said));
    }
  }
}
