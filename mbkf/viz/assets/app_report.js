// The session's report in a dialog: what it is compared with, norms, printing, and files to keep.
"use strict";

async function sessionReport(session, act) {
  const found = await ask("report/choices?" + query({ session }));
  const chosenBefore = choice(word("compare_with"), found.sessions, word("nothing"));
  const chosenNorms = choice(word("norms"), found.norms, word("none_of_them"));
  const frame = element("iframe", { title: word("session_report") });
  const source = () => "report?" + query({ session, before: chosenBefore.select.value, norms: chosenNorms.select.value, language });
  const show = () => { frame.contentWindow.location.replace(source()); }; // no step of its own for back
  chosenBefore.select.onchange = chosenNorms.select.onchange = show;
  const build = element("button", { type: "button", onclick: async () => {
    const chosen = await ask("norms/selection?" + query({ session }));
    const parts = [word("norms_of", chosen.persons.length, chosen.cycles), ...chosen.persons];
    if (chosen.left_out.length) parts.push("", word("norms_without"), ...chosen.left_out);
    if (!window.confirm(parts.join("\n"))) return;
    const made = await ask("norms?" + query({ session }), { method: "POST" });
    tell(word("norms_built", made.persons));
    if (![...chosenNorms.select.options].some((one) => one.value === made.norms)) chosenNorms.select.append(new Option(made.norms, made.norms));
    chosenNorms.select.value = made.norms;
    show();
  } }, word("build_norms"));
  const print = element("button", { type: "button", onclick: () => frame.contentWindow.print() }, word("print"));
  const keep = (href, name, label) => element("a", { className: "button", href, download: name }, label);
  const save = keep("", `${fileName(session)}.html`, word("save"));
  save.onclick = () => { save.href = source(); };
  const curves = ["csv", "parquet"].map((kind) => keep("report/curves?" + query({ session, as: kind }), `${fileName(session)}-curves.${kind}`, kind.toUpperCase()));
  act.dialog(session, frame, [chosenBefore.label, chosenNorms.label, build, print, save, ...curves]);
  show();
}

function choice(title, names, without) {
  const select = element("select", {}, new Option(without, ""), ...names.map((name) => new Option(name, name)));
  return { select, label: element("label", {}, title + " ", select) };
}

const fileName = (session) => (session === "." ? "session" : session.replaceAll("/", "-"));
