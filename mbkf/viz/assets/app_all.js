// All sessions of the page: their list with the progress of each, one button that runs them all, and one that stops them.
"use strict";

const NOT_DONE = { failed: "failed", not_ready: "not_ready", cancelled: "stopped" };

function allSessions(sessions, act) {
  const list = element("ul", { className: "sessions" }, ...sessions.map((one) => element("li", {}, sessionButton(one), ...sessionNotes(one))));
  return sessions.length < 2 ? [list] : [keyed(runAll(sessions, act), "all"), list];
}

function runAll(sessions, act) {
  const count = (state) => sessions.filter((one) => one.run && one.run.state === state).length;
  const running = count("running"), waiting = count("waiting"), row = element("div", { className: "run-all" });
  row.append(element("button", { type: "button", disabled: running + waiting === sessions.length, onclick: () => act.runAll("start") }, word("run_all")));
  if (running + waiting) row.append(element("button", { type: "button", onclick: () => act.runAll("cancel") }, word("stop_all")), element("span", {}, queueText(sessions)));
  return row;
}

// The queue of runs in words; empty while one session at most is calculated.
function queueText(sessions) {
  const count = (state) => sessions.filter((one) => one.run && one.run.state === state).length;
  return count("waiting") ? word("queue", count("running"), count("waiting")) : "";
}

function sessionButton(one) {
  const button = element("button", { className: "session", type: "button", onclick: () => go(one.id) }, element("span", {}, titleOf(one.id)), ...badges(one));
  button.dataset.key = `session ${one.id}`;
  button.setAttribute("aria-current", String(one.id === chosen));
  return button;
}

// Below a session: its progress while it is calculated, or the reason for which it was not.
function sessionNotes(one) {
  if (!one.run) return [];
  if (one.run.state === "running") {
    const bar = progressBar(one.run, titleOf(one.id));
    return [element("div", { className: "session-note" }, bar, one.run.total ? " " + word("of", one.run.done, one.run.total) : "")];
  }
  return one.run.reason ? [element("div", { className: "session-note bad" }, one.run.reason)] : [];
}

function progressBar({ done, share, total }, label) {
  const bar = element("progress", { max: Math.max(total, 1), value: done + share });
  bar.setAttribute("aria-label", label);
  return bar;
}

// The state of a session in short; green only where every trial may be used.
function badges(one) {
  const badge = (kind, text) => element("span", { className: `status ${kind}` }, text), state = one.run && one.run.state;
  if (state === "running") return [badge("running", word("running"))];
  if (state === "waiting") return [badge("waiting", word("waiting_short"))];
  const found = one.failed ? [badge("failed", word("failed_of", one.failed, one.trials))] : NOT_DONE[state] ? [badge("failed", word(NOT_DONE[state]))] : [];
  return one.verdict ? [...found, verdictBadge({ word: one.verdict })] : found;
}
