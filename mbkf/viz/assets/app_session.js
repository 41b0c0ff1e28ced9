// One session on the page: the person, the trials, the run.
"use strict";

const KIND_WORDS = { static: "static", walk: "walk", run: "run_kind", squat: "squat", jump: "jump", turn: "turn", stairs: "stairs", sit_to_stand: "sit_to_stand", unknown: "unknown" };
const VERDICT_WORDS = { "use": "verdict_use", "look": "verdict_look", "do not use": "verdict_do_not_use" };
const STAGE_WORDS = { "Reading": "stage_reading", "Following markers alone": "stage_markers", "Filtering": "stage_filtering", "Writing": "stage_writing" };

// The parts of a session, and the data that each of them shows: a part is drawn again when these change.
const PARTS = [
  ["heading", heading, (data) => [data.id, data.notes.name]],
  ["person", person, (data) => [data.id, data.notes, data.version, data.standing_kg]],
  ["visit", visitSection, (data) => [data.id, data.notes, data.version, data.trials.map((one) => [one.name, one.kind, one.excluded])]],
  ["problems", problemsOf, (data) => [data.id, data.problems]],
  ["run", run, (data) => [data.id, data.run, data.scaled_from, data.trials.map((one) => one.status)]],
  ["live", liveSection, (data) => [data.id]],
  ["trials", trials, (data) => [data.id, data.notes, data.version, data.trials.map((one) => ({ ...one, under_way: Boolean(one.under_way) }))]],
];
let parts = new Map();

// Draws everything anew next time, e.g. in another language.
function forget() {
  parts = new Map();
  place("session").replaceChildren();
}

function drawParts(main, data, act) {
  for (const [name, make, of] of PARTS) {
    const state = JSON.stringify(of(data)), known = parts.get(name);
    if (known && (known.state === state || isTyping(known.made))) continue;
    const made = keyed(make(data, act) || element("div", { hidden: true }), name);
    if (known) known.made.replaceWith(made);
    else main.append(made);
    parts.set(name, { state, made });
  }
  for (const one of data.trials) {
    const cell = main.querySelector(`[data-under-way="${CSS.escape(one.name)}"]`);
    if (cell && one.under_way) cell.replaceChildren(underWay(one));
  }
}

// A part with a text that is being written is left alone until that is done.
function isTyping(part) {
  const focused = document.activeElement;
  return document.hasFocus() && part.contains(focused) && /^(text|textarea|number|date)$/.test(focused.type) && focused.value !== focused.defaultValue;
}

function heading(data, act) {
  const title = data.id === "." ? data.notes.name || "·" : data.id;
  return element("div", { className: "head title" }, element("h2", {}, title), data.id === "." ? "" : filesMenu(data.id, "", act));
}

function titled(name, help, act, ...more) {
  return element("div", { className: "head" }, element("h3", {}, word(name)), helpButton(help, act), element("span", { className: "space" }), ...more);
}

function field(label, input) {
  return element("label", {}, label, input);
}

function person(data, act) {
  const notes = data.notes;
  const form = element("form", { className: "person", noValidate: true });
  const number = (name) => element("input", { name, type: "text", inputMode: "decimal", className: "number", value: shownNumber(notes[name]) });
  const sex = element("select", { name: "sex" }, ...["", "female", "male", "other"].map((one) =>
    element("option", { value: one, selected: (notes.sex || "") === one }, word(one || "unknown_sex"))));
  const scaling = element("select", { name: "scaling" }, ...["", "static"].map((one) =>
    element("option", { value: one, selected: (notes.scaling === "static") === (one === "static") }, word(one ? "by_static" : "by_session"))));
  form.append(
    field(word("name"), element("input", { name: "name", type: "text", value: notes.name || "" })),
    field(word("mass"), number("mass_kg")), field(word("height"), number("height_m")),
    field(word("sex"), sex), field(word("age"), number("age")), field(word("scaled_by"), scaling));
  if (data.standing_kg) {
    const kg = data.standing_kg.toFixed(1);
    const take = element("button", { type: "button", onclick: () => act.person(data, { mass_kg: Number(kg) }) }, word("take"));
    form.append(element("span", { className: "offer" }, word("bear", shownNumber(kg)) + " ", take));
  }
  form.onchange = (event) => {
    const { name, value, className } = event.target, number = className === "number" && value !== "";
    if (number && Number.isNaN(numberIn(value))) return tell(word("no_number", value), true);
    act.person(data, { [name]: value === "" ? undefined : number ? numberIn(value) : value });
  };
  form.onsubmit = (event) => event.preventDefault();
  return element("section", {}, titled("person", "person", act), form);
}

function problemList(problems, act) {
  return element("ul", { className: "problems" }, ...problems.map((one) =>
    element("li", { className: one.grave ? "grave" : "" }, element("b", {}, word(`problem_${one.key}`, ...one.values.map(shownNumber))), ": " + word(`todo_${one.key}`), ...(one.marker_set ? [" ", markerSetButton(act)] : []))));
}

function markerSetButton(act) {
  return element("button", { type: "button", className: "marker-set", onclick: () => act.markerSet() }, word("marker_set"));
}

function problemsOf(data, act) {
  return data.problems.length ? element("section", {}, titled("problems", "problems", act), problemList(data.problems, act)) : "";
}

function run(data, act) {
  const state = data.run, busy = isBusy(state);
  const row = element("div", { className: "run" });
  row.append(element("button", { className: "main", type: "button", disabled: Boolean(busy), onclick: () => act.run("start") }, word(state && !busy ? "again" : "run")));
  if (data.trials.some((one) => one.status === "done" || one.status === "unchanged")) {
    row.append(element("button", { id: "session-report", className: "main", type: "button", onclick: act.report }, word("session_report")));
  }
  const section = element("section", { className: "running" }, titled("calculation", "run", act), row);
  if (!state) return section;
  if (busy) {
    const bar = progressBar(state, word("trials"));
    const left = state.remaining_s === null ? "" : " · " + word("remaining", duration(state.remaining_s));
    row.append(bar, element("span", {}, runText(data) + left), element("button", { type: "button", onclick: () => act.run("cancel") }, word("cancel")));
  } else {
    row.append(element("span", { className: ["failed", "not_ready"].includes(state.state) || failedTrials(data) ? "bad" : "" }, runText(data)));
    if (state.persons.length) row.append(element("button", { type: "button", className: "separate", onclick: act.separate }, word("separate", state.persons.join(", "))));
  }
  if (!busy && data.scaled_from.length) row.append(element("span", { className: "scaled-from", title: data.scaled_why.join("\n") }, `${word("scaled_by")}: ${data.scaled_from.join(", ")}`));
  return section;
}

const isBusy = (state) => Boolean(state) && (state.state === "running" || state.state === "waiting");
const failedTrials = (data) => data.trials.filter((one) => one.status === "failed").length;

// The state of a run in words.
function runText(data) {
  const state = data.run;
  if (!state) return "";
  if (state.state === "waiting") return word("waiting");
  if (state.state === "running") return state.done || state.stage ? word("of", state.done, state.total) : word("scaling");
  if (state.state === "cancelled") return word("cancelled");
  if (state.state === "failed") return word("failed_run", state.reason);
  if (state.state === "not_ready") return word("left_out_run", state.reason);
  const failed = failedTrials(data);
  return failed ? word("finished_failed", duration(state.seconds), failed, data.trials.filter((one) => one.status).length) : word("finished", duration(state.seconds));
}

const COLUMNS = ["trial", "kind", "content", "use", "problems", "result"];

function trials(data, act) {
  const head = element("tr", { role: "row" }, ...COLUMNS.map((name) => element("th", { role: "columnheader", scope: "col" }, word(name))));
  const body = data.trials.map((one) => trialRow(data, one, act));
  return element("section", {}, titled("trials", "trials", act, helpButton("kinds", act, word("help_kinds")), markerSetButton(act)),
    element("table", { role: "table", ariaLabel: word("trials") }, element("thead", { role: "rowgroup" }, head), element("tbody", { role: "rowgroup" }, ...body)));
}

function underWay(trial) {
  const { stage, done, total, share } = trial.under_way;
  const bar = element("progress", { max: 1, value: share });
  bar.setAttribute("aria-label", trial.name);
  const words = STAGE_WORDS[stage] ? word(STAGE_WORDS[stage]) : stage;
  return element("div", { className: "under-way" }, bar, " " + words + (total > 1 ? ": " + word("frames_of", done, total) : ""));
}

function verdictBadge({ word: said, line }, status = "") {
  return element("span", { className: `status ${status} verdict-${said.replaceAll(" ", "-")}`, title: line || "" }, word(VERDICT_WORDS[said]));
}

function trialRow(data, one, act) {
  const kind = element("select", { onchange: () => act.trial(data, one.name, { kind: kind.value }) }, ...data.kinds.map((name) =>
    element("option", { value: name, selected: name === one.kind }, word(KIND_WORDS[name]))));
  kind.setAttribute("aria-label", `${word("kind")}: ${one.name}`);
  const use = element("input", { type: "checkbox", checked: !one.excluded, onchange: () => act.trial(data, one.name, { excluded: use.checked ? undefined : "–" }) });
  use.setAttribute("aria-label", `${word("use")}: ${one.name}`);
  const out = element("td", {}, use);
  if (one.excluded) {
    const why = element("input", { type: "text", value: one.excluded === "–" ? "" : one.excluded, placeholder: word("why"), onchange: () => act.trial(data, one.name, { excluded: why.value || "–" }) });
    why.setAttribute("aria-label", `${word("why")}: ${one.name}`);
    out.append(" ", why);
  }
  const result = element("td", {});
  if (one.verdict) result.append(verdictBadge(one.verdict, one.status));
  else if (one.status) result.append(element("span", { className: `status ${one.status}` }, word(one.status)));
  if (one.status === "failed") result.append(" " + one.reason);
  if (one.under_way) {
    const progress = element("div", {}, underWay(one));
    progress.dataset.underWay = one.name;
    result.replaceChildren(progress);
  }
  if (one.status === "done" || one.status === "unchanged") {
    const show = (look) => element("button", { type: "button", onclick: () => act.open(look, one.name) }, word(look));
    if (one.verdict && one.verdict.reasons.length) result.append(element("details", { className: "reasons" }, element("summary", {}, word("reasons")), element("ul", {}, ...one.verdict.reasons.map((text) => element("li", {}, text)))));
    result.append(element("div", { className: "buttons" }, show("look"), show("report"), exportMenu(data, one)));
  }
  if (one.live) out.replaceChildren("–");
  const seen = one.usable || one.seconds;
  const content = seen ? [word("seconds", numeral(one.seconds, 1)), word("markers_count", one.markers || one.unnamed), ...(one.plates ? [word("plates_count", one.plates)] : [])].join(", ") : "–";
  const rehearse = one.usable && !one.live && one.kind !== "static" ? [[word("rehearse"), () => act.open("live", one.name)]] : [];
  const row = element("tr", { role: "row", className: one.excluded ? "out" : "" },
    element("td", {}, element("b", {}, one.file), filesMenu(data.id, one.name, act, rehearse, one.live)), element("td", {}, one.live ? word("live_recording") : kind),
    element("td", {}, content), out, element("td", {}, one.problems.length ? problemList(one.problems, act) : ""), result);
  [...row.children].forEach((cell, k) => {
    cell.dataset.label = word(COLUMNS[k]);
    cell.setAttribute("role", "cell");
    cell.classList.toggle("empty", !cell.textContent && !cell.children.length);
  });
  return keyed(row, `trial ${one.name}`);
}
