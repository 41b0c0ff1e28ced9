// The page of sessions: a list on the left, one session on the right; asks the server again while something runs.
"use strict";

const AGAIN_MS = 1000;
const place = (id) => document.getElementById(id);
let chosen = null, shown = null, timer = 0;

async function ask(path, options = {}) {
  let answer;
  try {
    answer = await fetch(path, options);
  } catch (error) {
    tell(word("lost"), true);
    throw error;
  }
  const said = await answer.json();
  if (!answer.ok) {
    tell(said.trouble, true);
    throw new Error(said.trouble);
  }
  return said;
}

const query = (values) => new URLSearchParams(values).toString();

function tell(text, bad = false) {
  const told = place("told");
  told.textContent = text;
  told.className = bad ? "bad" : "";
  if (!bad) setTimeout(() => { if (told.textContent === text) told.textContent = ""; }, 2500);
}

const act = {
  async save(change) {
    const notes = structuredClone(shown.notes);
    change(notes);
    draw(await ask("session?" + query({ session: chosen }), { method: "POST", body: JSON.stringify(notes) }));
    tell(word("saved"));
  },
  person: (values) => act.save((notes) => Object.assign(notes, values)),
  trial: (name, values) => act.save((notes) => {
    notes.trial = notes.trial || {};
    notes.trial[name] = Object.assign(notes.trial[name] || {}, values);
  }),
  async run(what) {
    await ask("run?" + query({ session: chosen, do: what }), { method: "POST" });
    await refresh();
  },
  show(look, trial) {
    act.dialog(trial, element("iframe", { src: `trial/${look}?` + query({ session: chosen, trial }), title: `${trial}: ${word(look)}` }));
  },
  dialog(title, content, tools = []) {
    const dialog = element("dialog", { onclose: () => { dialog.remove(); refresh(); } });
    dialog.setAttribute("aria-label", title);
    const close = element("button", { type: "button", onclick: () => dialog.close() }, word("close"));
    dialog.append(element("div", { className: "bar" }, element("b", {}, title), ...tools, close), content);
    document.body.append(dialog);
    dialog.showModal();
  },
  report: () => sessionReport(chosen, act),
  markerSet() {
    act.dialog(word("marker_set"), element("iframe", { src: "marker_set?" + query({ session: chosen }), title: word("marker_set") }));
  },
};

function draw(data) {
  const focused = document.activeElement, main = place("session");
  if (main.contains(focused) && focused.tagName === "INPUT" && focused.type !== "checkbox" && shown && shown.id === data.id && document.hasFocus() && data.run && data.run.state === "running") return;
  const at = [...main.querySelectorAll("input, select, button")].indexOf(focused);
  shown = data;
  main.replaceChildren(...sessionView(data, act));
  if (at >= 0) main.querySelectorAll("input, select, button")[at]?.focus();
  clearTimeout(timer);
  if (data.run && (data.run.state === "running" || data.run.state === "waiting")) timer = setTimeout(refresh, AGAIN_MS);
}

async function refresh() {
  const known = await ask("sessions");
  place("folder").textContent = known.folder;
  if (!known.sessions.some((one) => one.id === chosen)) chosen = known.sessions.length ? known.sessions[0].id : null;
  const list = known.sessions.map((one) => {
    const state = one.run ? element("span", { className: `status ${one.run.state === "finished" ? "done" : one.run.state}` }, one.run.state === "finished" ? "✓" : one.run.state === "running" ? "…" : "") : "";
    const button = element("button", { className: "session", type: "button", onclick: () => { chosen = one.id; refresh(); } }, one.id === "." ? "·" : one.id, state);
    button.setAttribute("aria-current", String(one.id === chosen));
    return button;
  });
  place("sessions").replaceChildren(dropZone(), ...list);
  if (chosen === null) place("session").replaceChildren(element("p", {}, word("no_session")));
  else draw(await ask("session?" + query({ session: chosen })));
}

function dropZone() {
  const pick = (folder) => {
    const input = element("input", { type: "file", multiple: true, hidden: true, webkitdirectory: folder });
    input.onchange = () => take([...input.files].map((file) => [file.webkitRelativePath || file.name, file]));
    return [element("button", { type: "button", onclick: () => input.click() }, word(folder ? "choose_folder" : "choose_files")), input];
  };
  const zone = element("div", { className: "drop" }, word("drop"), element("div", { className: "choose" }, ...pick(true), ...pick(false)));
  zone.ondragover = (event) => { event.preventDefault(); zone.classList.add("over"); };
  zone.ondragleave = () => zone.classList.remove("over");
  zone.ondrop = async (event) => {
    event.preventDefault();
    zone.classList.remove("over");
    const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry()).filter(Boolean);
    take((await Promise.all(entries.map((entry) => filesOf(entry, "")))).flat());
  };
  return zone;
}

async function filesOf(entry, above) {
  const path = above + entry.name;
  if (entry.isFile) return [[path, await new Promise((done, failed) => entry.file(done, failed))]];
  const reader = entry.createReader(), found = [];
  for (;;) {
    const some = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (!some.length) return found;
    for (const one of some) found.push(...await filesOf(one, path + "/"));
  }
}

async function take(files) {
  const kept = files.filter(([path]) => !path.split("/").some((part) => part.startsWith(".")));
  const alone = kept.every(([path]) => !path.includes("/"));
  const refused = [];
  const into = alone ? `${shown && chosen !== "." ? chosen : "session"}/` : "";
  for (const [k, [path, file]] of kept.entries()) {
    tell(word("uploading", k + 1, kept.length));
    try {
      await ask("put?" + query({ file: into + path }), { method: "POST", body: file });
    } catch (error) {
      refused.push(error.message);
    }
  }
  if (refused.length) tell(word("not_taken", refused.length, refused[0]), true);
  else tell(word("uploaded", kept.length));
  if (kept.length) chosen = (into + kept[0][0]).split("/").slice(0, -1).join("/");
  await refresh();
}

function chooseLanguage() {
  const select = element("select", { onchange: () => { language = select.value; localStorage.setItem("mbkf language", language); start(); } },
    ...Object.keys(WORDS).map((name) => element("option", { value: name, selected: name === language }, WORDS[name].name)));
  place("language").replaceChildren(word("language") + " ", select);
}

function start() {
  document.documentElement.lang = language;
  chooseLanguage();
  refresh();
}

addEventListener("message", (event) => {
  if (event.origin === location.origin && event.data === "marker set done") document.querySelector("dialog[open]")?.close();
});

start();
