// The waiting page: what the terminal says, large, and how much of the standing is done; then the live page follows.
"use strict";

const AGAIN_MS = 300, LOST_MS = 3000, LONG = 110, OWN = '<body id="standing">';

class Standing {
  constructor() {
    const part = (id) => document.getElementById(id);
    document.documentElement.lang = language;
    [this.trial, this.state, this.said, this.share] = ["trial", "state", "said", "share"].map(part);
    this.share.setAttribute("aria-label", word("live_standing_still"));
    this.show(null);
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/frames${location.search}`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => {
      this.gone = 0;
      if (typeof data === "string") this.begin(JSON.parse(data));
      else this.take(JSON.parse(new TextDecoder().decode(data)));
    };
    socket.onclose = () => {
      this.gone ||= performance.now();
      this.tell(word("live_connecting"), "wait");
      this.again();
    };
  }

  again() { setTimeout(() => this.follow(), AGAIN_MS); }

  // What stands at this address now: the live page, this one anew, or nothing.
  async follow() {
    const text = await fetch(location.href).then((answer) => (answer.ok ? answer.text() : null)).catch(() => null);
    if (text === null) {
      if (performance.now() - this.gone > LOST_MS) this.lose();
      this.again();
    } else if (text.includes(OWN)) this.connect();
    else location.reload();
  }

  begin({ title }) {
    this.trial.textContent = title;
    document.title = `${title} · mbkf`;
  }

  take({ text, share, said }) {
    learn(said);
    this.say(spoken(text));
    this.show(share);
    this.tell(word(share === null ? "live_no_frames" : "live_frames"), share === null ? "wait" : "good");
  }

  // The first clause stands out, so the sign after it need not be seen; all parts are the sentence as it was said.
  say(text) {
    const [, ...parts] = /^(.*?)([:;,] )(.*)$/s.exec(text) || [null, text, "", ""];
    parts.forEach((part, k) => { this.said.children[k].textContent = part; });
    this.said.className = text.length > LONG ? "long" : "";
  }

  show(share) {
    this.share.className = share === null ? "none" : share >= 1 ? "full" : "";
    this.share.firstChild.style.width = `${100 * (share || 0)}%`;
    this.share.setAttribute("aria-valuenow", Math.round(100 * (share || 0)));
  }

  tell(text, kind) {
    this.state.textContent = text;
    this.state.dataset.kind = kind;
  }

  lose() {
    this.say(word("live_no_answer"));
    this.said.className = "lost";
    this.show(null);
    this.tell(word("live_gone"), "bad");
  }
}

window.mbkf = new Standing();
