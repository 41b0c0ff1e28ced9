// Events go to the server soon after they change, one request at a time; what was not taken is said and kept.
"use strict";

const SAVE_MS = 400;

class Saving {
  // address: where to; say(text, bad): tells how it went.
  constructor(address, say) {
    Object.assign(this, { address, say, waiting: null, timer: 0, busy: false });
    addEventListener("pagehide", () => {
      if (this.waiting) fetch(this.address, { method: "POST", body: this.waiting(), keepalive: true });
    });
  }

  // body(): the text to send, asked for when it is sent.
  soon(body) {
    this.waiting = body;
    this.say(word("saving"));
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.now(), SAVE_MS);
  }

  async now() {
    if (this.busy || !this.waiting) return;
    const body = this.waiting;
    [this.busy, this.waiting] = [true, null];
    try {
      const answer = await fetch(this.address, { method: "POST", body: body() }), said = await answer.json();
      if (!answer.ok) throw new Error(said.trouble);
      if (!this.waiting) this.say(said.cycles ? word("saved", ...said.cycles) : word("saved_later"));
    } catch (error) {
      this.waiting = this.waiting || body;
      this.say(word("not_saved", error instanceof TypeError ? word("lost") : error.message), true);
      this.busy = false;
      return;
    }
    this.busy = false;
    if (this.waiting) this.now();
  }
}
