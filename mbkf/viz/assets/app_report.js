// The session's report in a dialog: what it is compared with, norms, printing, and files to keep.
"use strict";

async function sessionReport(session, act) {
  const found = await ask("report/choices?" + query({ session }));
  const chosenBefore = choice(word("compare_with"), found.sessions, word("nothing"));
  const chosenNorms = choice(word("norms"), found.norms, word("none_of_them"));
  const trend = element("input", { type: "checkbox" }), several = found.visits >= 2;
  const frame = element("iframe", { title: word("session_report") });
  const pick = (name, values) => {
    const select = element("select", {}, ...values.map((one) => new Option(word(one.replace("-", "_")), one)));
    select.value = found.charts[name];
    return { select, label: element("label", {}, word(name) + " ", select) };
  };
  const picked = Object.entries(found.chart_choices).map(([name, values]) => [name, pick(name, values)]);
  const straight = element("input", { type: "checkbox" });
  const charts = () => ({ ...Object.fromEntries(picked.map(([name, one]) => [name, one.select.value])), straight: straight.checked ? 1 : "" });
  const source = () => "report?" + query({ session, before: chosenBefore.select.value, norms: chosenNorms.select.value, language, trend: trend.checked ? 1 : "", ...charts() });
  const show = () => { frame.contentWindow.location.replace(source()); }; // no step of its own for back
  for (const one of [chosenBefore, chosenNorms, ...picked.map(([, one]) => one)]) one.select.onchange = () => { show(); link(); };
  trend.onchange = () => show();
  straight.onchange = () => { show(); link(); };
  const take = (norms) => {
    if (![...chosenNorms.select.options].some((one) => one.value === norms)) chosenNorms.select.append(new Option(norms, norms));
    chosenNorms.select.value = norms;
    show();
  };
  const build = element("button", { type: "button", onclick: async () => {
    const chosen = await ask("norms/selection?" + query({ session, language }));
    const parts = [word("norms_of", chosen.persons.length, chosen.cycles), ...chosen.persons];
    if (chosen.left_out.length) parts.push("", word("norms_without"), ...chosen.left_out);
    if (!window.confirm(parts.join("\n"))) return;
    const made = await ask("norms?" + query({ session, ...charts() }), { method: "POST" });
    tell(word("norms_built", made.persons));
    take(made.norms);
  } }, word("build_norms"));
  const load = element("button", { type: "button", onclick: () => normsForm(act, take) }, word("import_norms"));
  load.dataset.key = "import norms";
  const beside = (name, text) => (name ? [element("button", { type: "button", onclick: () => otherReport(name, act) }, word(text, titleOf(name)))] : []);
  const print = element("button", { type: "button", onclick: () => frame.contentWindow.print() }, word("print"));
  const keep = (href, name, label) => element("a", { className: "button", href, download: name }, label);
  const save = keep("", `${fileName(session)}.html`, word("save"));
  save.onclick = () => { save.href = source(); };
  const curves = ["csv", "parquet"].map((kind) => [kind, keep("", `${fileName(session)}-curves.${kind}`, kind.toUpperCase())]);
  const link = () => { for (const [kind, one] of curves) one.href = "report/curves?" + query({ session, as: kind, ...charts() }); };
  link();
  act.dialog(session, frame, [...beside(found.previous, "previous_report"), ...beside(found.next, "next_report"), chosenBefore.label, ...(several ? [element("label", {}, trend, " " + word("all_visits"))] : []), chosenNorms.label, ...picked.map(([, one]) => one.label), element("label", {}, straight, " " + word("straight_only")), build, load, print, save, ...curves.map(([, one]) => one)]);
  show();
}

async function otherReport(session, act) {
  await go(session);
  act.report();
}

function choice(title, names, without) {
  const select = element("select", {}, new Option(without, ""), ...names.map((name) => new Option(name, name)));
  return { select, label: element("label", {}, title + " ", select) };
}

const fileName = (session) => (session === "." ? "session" : session.replaceAll("/", "-"));
