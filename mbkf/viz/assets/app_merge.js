// Fields that another page, person or program changed meanwhile: both values are shown, and the person chooses.
"use strict";

const FIELD_WORDS = { name: "name", mass_kg: "mass", height_m: "height", sex: "sex", age: "age", protocol: "marker_set", scaling: "scaled_by", kind: "kind", excluded: "why", event: "look", date: "visit_date", birth_date: "birth_date", condition: "condition", side: "affected", diagnosis: "diagnosis", notes: "visit_notes", clinician: "clinician" };

// choose(values): called with the chosen differences, those where the person keeps the own value.
function differencesDialog(differences, choose, dialog) {
  const rows = differences.map((one, k) => {
    const last = one.field.at(-1), title = [...one.field.slice(1, -1), FIELD_WORDS[last] ? word(FIELD_WORDS[last]) : last].join(" · ");
    const pick = (which, checked) => {
      const input = element("input", { type: "radio", name: `field${k}`, value: which, checked });
      return element("td", {}, element("label", {}, input, " ", valueText(one[which])));
    };
    return element("tr", {}, element("th", { scope: "row" }, title), pick("mine", false), pick("theirs", true));
  });
  const head = element("tr", {}, ...["field", "mine", "theirs"].map((name) => element("th", { scope: "col" }, word(name))));
  const form = element("form", { className: "differences", method: "dialog" }, element("p", {}, word("differ")),
    element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)), element("button", { className: "main" }, word("save_choice")));
  form.onsubmit = (event) => {
    event.preventDefault();
    const kept = differences.filter((_, k) => form.elements[`field${k}`].value === "mine");
    form.closest("dialog").close();
    choose(kept);
  };
  document.querySelector("form.differences")?.closest("dialog").remove();
  dialog(word("differ_title"), form);
}

function valueText(value) {
  if (value === null || value === undefined || value === "") return "–";
  return Array.isArray(value) ? word("events_count", value.length) : String(value);
}

// The notes with the own value of each kept difference.
function withOwn(notes, kept) {
  const made = structuredClone(notes);
  for (const { field, mine } of kept) {
    let table = made;
    for (const key of field.slice(0, -1)) table = table[key] ||= {};
    if (mine === null) delete table[field.at(-1)];
    else table[field.at(-1)] = mine;
  }
  return made;
}
