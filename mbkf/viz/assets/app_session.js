// One session on the page: the person, the trials, the run.
"use strict";

const KIND_WORDS = { static: "static", walk: "walk", run: "run_kind", squat: "squat", jump: "jump", turn: "turn", stairs: "stairs", sit_to_stand: "sit_to_stand", unknown: "unknown" };
const VERDICT_WORDS = { "use": "verdict_use", "look": "verdict_look", "do not use": "verdict_do_not_use" };
const STAGE_WORDS = { "Reading": "stage_reading", "Following markers alone": "stage_markers", "Filtering": "stage_filtering", "Writing": "stage_writing" };

function sessionView(data, act) {
  return [element("h2", {}, data.id === "." ? data.notes.name || "·" : data.id), person(data, act), problemsOf(data, act), run(data, act), liveSection(data, act), trials(data, act)];
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
  return element("section", {}, element("h3", {}, word("person")), form);
}

function problemList(problems, act) {
  return element("ul", { className: "problems" }, ...problems.map((one) =>
    element("li", { className: one.grave ? "grave" : "" }, element("b", {}, word(`problem_${one.key}`, ...one.values.map(shownNumber))), ": " + word(`todo_${one.key}`), ...(one.marker_set ? [" ", markerSetButton(act)] : []))));
}

function markerSetButton(act) {
  return element("button", { type: "button", className: "marker-set", onclick: () => act.markerSet() }, word("marker_set"));
}

function problemsOf(data, act) {
  return data.problems.length ? element("section", {}, problemList(data.problems, act)) : "";
}

function run(data, act) {
  const state = data.run, busy = state && (state.state === "running" || state.state === "waiting");
  const row = element("div", { className: "run" });
  row.append(element("button", { className: "main", type: "button", disabled: Boolean(busy), onclick: () => act.run("start") }, word(state && !busy ? "again" : "run")));
  if (data.trials.some((one) => one.status === "done" || one.status === "unchanged")) {
    row.append(element("button", { id: "session-report", className: "main", type: "button", onclick: act.report }, word("session_report")));
  }
  if (!state) return element("section", {}, row);
  if (busy) {
    const total = Math.max(state.total, 1);
    const bar = element("progress", { max: total, value: state.done + state.share });
    bar.setAttribute("aria-label", word("trials"));
    const left = state.remaining_s === null ? "" : " · " + word("remaining", duration(state.remaining_s));
    const said = state.state === "waiting" ? word("waiting") : state.done || state.stage ? word("of", state.done, state.total) + left : word("scaling");
    row.append(bar, element("span", {}, said), element("button", { type: "button", onclick: () => act.run("cancel") }, word("cancel")));
  } else {
    const said = { finished: () => word("finished", duration(state.seconds)), cancelled: () => word("cancelled"), failed: () => word("failed_run", state.reason) };
    row.append(element("span", {}, said[state.state]()));
    if (state.persons.length) row.append(element("button", { type: "button", className: "separate", onclick: act.separate }, word("separate", state.persons.join(", "))));
  }
  if (!busy && data.scaled_from.length) row.append(element("span", { className: "scaled-from", title: data.scaled_why.join("\n") }, `${word("scaled_by")}: ${data.scaled_from.join(", ")}`));
  return element("section", {}, row);
}

function trials(data, act) {
  const heads = [["trial"], ["kind"], ["length", "number"], ["markers", "number"], ["plates", "number"], ["use"], ["problems"], ["result"]];
  const head = element("tr", {}, ...heads.map(([name, kind]) => element("th", { className: kind || "", scope: "col" }, word(name))));
  const body = data.trials.map((one) => trialRow(data, one, act));
  return element("section", {}, element("div", { className: "head" }, element("h3", {}, word("trials")), markerSetButton(act)),
    element("div", { className: "table" }, element("table", {}, element("thead", {}, head), element("tbody", {}, ...body))));
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
  if (one.under_way) result.replaceChildren(underWay(one));
  if (one.status === "done" || one.status === "unchanged") {
    const show = (look) => element("button", { type: "button", onclick: () => act.open(look, one.name) }, word(look));
    if (one.verdict && one.verdict.reasons.length) result.append(element("details", { className: "reasons" }, element("summary", {}, word("reasons")), element("ul", {}, ...one.verdict.reasons.map((text) => element("li", {}, text)))));
    result.append(element("div", { className: "buttons" }, show("look"), show("report"), exportSelect(data, one)));
  }
  if (one.live) out.replaceChildren("–");
  const seen = one.usable || one.seconds;
  return element("tr", { className: one.excluded ? "out" : "" },
    element("td", {}, one.file), element("td", {}, one.live ? word("live_recording") : kind),
    element("td", { className: "number" }, seen ? word("seconds", numeral(one.seconds, 1)) : "–"),
    element("td", { className: "number" }, seen ? String(one.markers || one.unnamed) : "–"),
    element("td", { className: "number" }, seen ? String(one.plates ?? "–") : "–"), out,
    element("td", {}, one.problems.length ? problemList(one.problems, act) : ""), result);
}
