// The visit on the page: facts for the head of the report, the condition of each trial, and the laboratory.
"use strict";

const CONDITIONS = ["barefoot", "shoes", "orthosis", "prosthesis", "aid"];
const AFFECTED = { right: "side_right", left: "side_left", both: "side_both" };
const opened = new Set(); // parts of the form that the person opened stay open when the page is drawn anew

function visitSection(data, act) {
  const stated = data.notes.visit || {};
  const text = (name, label, type = "text") => field(word(label), element("input", { name, type, value: stated[name] || "" }));
  const side = element("select", { name: "side" }, ...["", ...Object.keys(AFFECTED)].map((one) =>
    element("option", { value: one, selected: (stated.side || "") === one }, one ? word(AFFECTED[one]) : "–")));
  const long = (name, label) => field(word(label), element("textarea", { name, rows: 2, value: stated[name] || "" }));
  const form = element("form", { className: "visit", noValidate: true },
    text("date", "visit_date", "date"), text("birth_date", "birth_date", "date"), field(word("condition"), conditionInput("condition", stated.condition)),
    field(word("affected"), side), text("clinician", "clinician"), text("diagnosis", "diagnosis"), long("notes", "visit_notes"));
  form.onchange = (event) => {
    const { name, value } = event.target;
    act.save(data, (notes) => { notes.visit = { ...notes.visit, [name]: (name === "condition" ? conditionOf(value) : value) || undefined }; });
  };
  form.onsubmit = (event) => event.preventDefault();
  const list = element("datalist", { id: "conditions" }, ...CONDITIONS.map((one) => element("option", { value: word(one) })));
  return element("section", { id: "visit" }, list, unfolding("visit", form, trialConditions(data, act), laboratoryForm()));
}

function unfolding(name, ...content) {
  const details = element("details", { open: opened.has(name) }, element("summary", {}, word(name)), ...content);
  details.ontoggle = () => opened[details.open ? "add" : "delete"](name);
  return details;
}

function conditionInput(name, value) {
  const input = element("input", { name, type: "text", value: CONDITIONS.includes(value) ? word(value) : value || "" });
  input.setAttribute("list", "conditions");
  return input;
}

const conditionOf = (text) => CONDITIONS.find((one) => word(one).toLowerCase() === text.trim().toLowerCase()) || text;

function trialConditions(data, act) {
  const moving = data.trials.filter((one) => !one.live && !one.excluded && one.kind !== "static");
  const form = element("form", { noValidate: true }, ...moving.map((one) => {
    const input = conditionInput("condition", (data.notes.trial?.[one.name] || {}).condition);
    input.onchange = () => act.trial(data, one.name, { condition: conditionOf(input.value) || undefined });
    return field(one.name, input);
  }));
  form.onsubmit = (event) => event.preventDefault();
  return unfolding("trial_conditions", form);
}

// Loaded when it is opened for the first time; it belongs to all sessions of the page.
function laboratoryForm() {
  const form = element("form", { noValidate: true }), details = unfolding("laboratory", form);
  const save = async (values) => {
    fill(await ask("laboratory", { method: "POST", body: JSON.stringify(values) }));
    tell(word("saved"));
  };
  const fill = (found) => {
    const name = element("input", { name: "laboratory", type: "text", value: found.name, onchange: () => save({ name: name.value }) });
    const address = element("textarea", { rows: 3, value: found.address, onchange: () => save({ address: address.value }) });
    const logo = element("input", { type: "file", accept: "image/png,image/jpeg", onchange: async () => save({ logo: await base64Of(logo.files[0]) }) });
    const remove = element("button", { type: "button", onclick: () => save({ logo: "" }) }, word("remove_logo"));
    form.replaceChildren(field(word("laboratory_name"), name), field(word("laboratory_address"), address), field(word("laboratory_logo"), logo), ...(found.logo ? [remove] : []));
  };
  const load = async () => { if (details.open && !form.children.length) fill(await ask("laboratory")); };
  form.onsubmit = (event) => event.preventDefault();
  details.addEventListener("toggle", load);
  return details;
}

function base64Of(file) {
  return new Promise((done, failed) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result.split(",")[1] || "");
    reader.onerror = failed;
    reader.readAsDataURL(file);
  });
}
