// Norms of other programs from a file: the page shows the facts that the file states and asks for the missing ones.
"use strict";

const NORM_WORDS = { name: "norm_name", source: "norm_source", convention: "norm_convention", moments: "norm_moments", persons: "norm_persons", ages: "norm_ages", speeds: "norm_speeds", group: "norm_group" };
const NORM_FACTS = Object.keys(NORM_WORDS);

// made(file): called with the name of the norms once they are written.
function normsForm(act, made) {
  const file = element("input", { name: "norm_file", type: "file", accept: ".csv,.tsv,.txt,.json,.gcd,.xlsx", required: true });
  const select = (name, values) => element("select", { name }, new Option(word("norm_choose"), ""), ...values.map((one) => new Option(word(one), one)));
  const inputs = Object.fromEntries(NORM_FACTS.map((name) => [name, element("input", { name, type: "text", autocomplete: "off" })]));
  inputs.convention = select("convention", ["clinical", "isb", "model"]);
  inputs.moments = select("moments", ["internal", "external"]);
  inputs.group = select("group", []);
  const labels = Object.fromEntries(NORM_FACTS.map((name) => [name, field(word(NORM_WORDS[name]), inputs[name])]));
  const wrong = element("p", { className: "wrong", role: "alert" });
  const form = element("form", { className: "norms", noValidate: true }, element("p", { className: "note" }, word("import_norms_note")),
    field(word("norm_file"), file), ...NORM_FACTS.map((name) => labels[name]), wrong, element("button", { className: "main" }, word("import_do")));
  labels.group.hidden = true;

  async function send(what) {
    wrong.textContent = "";
    const chosen = file.files[0];
    if (!chosen) {
      file.focus();
      return null;
    }
    const facts = Object.fromEntries(NORM_FACTS.map((name) => [name, inputs[name].value.trim()]));
    try {
      const answer = await fetch("norms/import?" + query({ do: what, file: chosen.name, ...facts }), { method: "POST", body: chosen }), said = await answer.json();
      if (!answer.ok) throw new Error(troubleOf(said));
      return said;
    } catch (error) {
      wrong.textContent = error instanceof TypeError ? word("lost") : error.message;
      return null;
    }
  }
  function ask(said) {
    if (said.groups.length && inputs.group.options.length !== said.groups.length + 1) inputs.group.replaceChildren(new Option(word("norm_choose"), ""), ...said.groups.map((one) => new Option(one, one)));
    labels.group.hidden = !said.groups.length;
    for (const [name, value] of Object.entries(said.facts)) if (!inputs[name].value && value) inputs[name].value = name === "ages" || name === "speeds" ? value.split("-").map(shownNumber).join("-") : value;
    for (const name of NORM_FACTS) inputs[name].setAttribute("aria-invalid", String(said.missing.includes(name)));
    if (!said.missing.length) return;
    wrong.textContent = word("norms_lack", said.missing.map((name) => word(NORM_WORDS[name]).replace(/[,(].*/, "").trim()).join("; "));
    inputs[said.missing[0]].focus();
  }
  file.onchange = async () => {
    for (const name of NORM_FACTS) inputs[name].value = "";
    inputs.group.replaceChildren(new Option(word("norm_choose"), ""));
    if (file.files[0]) inputs.name.value = file.files[0].name.replace(/\.[^.]*$/, "");
    const said = await send("look");
    if (said) ask(said);
  };
  form.onsubmit = async (event) => {
    event.preventDefault();
    const said = await send("write");
    if (!said) return;
    if (said.missing.length) return ask(said);
    made(said.norms);
    const done = element("button", { type: "button", className: "main", onclick: () => form.closest("dialog").close() }, word("to_report"));
    form.replaceChildren(element("p", { role: "status" }, word("norms_imported", said.norms, said.curves)),
      ...(said.turned.length ? [element("p", {}, word("norms_turned", said.turned.join(", ")))] : []),
      ...(said.left_out.length ? [element("p", {}, word("norms_left_out")), element("ul", {}, ...said.left_out.map((one) => element("li", {}, one)))] : []), done);
    done.focus();
  };
  const dialog = act.dialog(word("import_norms"), form);
  dialog.classList.add("small");
}
