// The page of sessions: a list on the left, one session on the right; asks the server again while something runs.
"use strict";

const AGAIN_MS = 1000;
const place = (id) => document.getElementById(id);
const told = place("told");
let chosen = null, shown = null, timer = 0, turns = 0, drawn = 0;
const written = new Map(); // the last change of each session, by its path

// A reply for a session that is shown no more is dropped, unless the request belongs to no session (still).
async function ask(path, options = {}, still = here(), send = fetch) {
  let answer;
  try {
    answer = await send(path, options);
  } catch (error) {
    await whileHere(still);
    tell(word("lost"), true);
    throw error;
  }
  const said = await whileHere(still, await answer.json());
  if (!answer.ok && !said.differences) {
    const trouble = troubleOf(said);
    tell(trouble, true);
    throw new Error(trouble);
  }
  return said;
}

// The changes of a session are sent one after the other, so that the last reply has them all.
function write(path, options) {
  const reply = Promise.resolve(written.get(path)).then(() => fetch(path, options));
  written.set(path, reply.catch(() => {}));
  return reply;
}

const query = (values) => new URLSearchParams(values).toString();
const notesOf = (session) => "session?" + query({ session });

// A reason from the server, in the page's language where it has one.
const troubleOf = (said) => (said.key && said.key in WORDS[language].words ? word(said.key, ...said.values) : said.trouble);

// A message stays until the next one where it is bad or offers something to click.
function tell(text, bad = false, ...offers) {
  placeMessages();
  told.replaceChildren(text, ...offers.flatMap((one) => [" ", one]));
  told.className = bad ? "bad" : "";
  if (bad || offers.length) told.append(" ", element("button", { type: "button", className: "away", ariaLabel: word("close"), onclick: () => tell("") }, "×"));
  else setTimeout(() => { if (told.textContent === text) told.textContent = ""; }, 2500);
}

// An open dialog covers the page and takes its clicks, so messages stand in the latest one.
function placeMessages() {
  const home = [...document.querySelectorAll("dialog[open]")].at(-1) || document.body;
  if (told.parentElement !== home) home.append(told);
}

// For those who hear the page: changes of a run that eyes see in its bar.
function announce(text) {
  const heard = place("heard");
  if (heard.textContent !== text) heard.textContent = text;
}

const act = {
  // Changes the notes that the person saw, which newer ones may have replaced since.
  async save(seen, change) {
    const notes = structuredClone(seen.notes);
    change(notes);
    await act.write(seen, notes);
  },
  // Sends the notes with those that the change began from; the server lays the change over the notes as they are now.
  async write(base, notes) {
    const turn = ++turns;
    const said = await ask(notesOf(base.id), {
      method: "POST", headers: { "If-Match": `"${base.version}"` }, body: JSON.stringify({ base: base.notes, notes }),
    }, here(), write);
    draw(said, turn);
    if (!said.differences) tell(word("saved"));
    else differencesDialog(said.differences, (kept) => { if (kept.length) act.write(said, withOwn(said.notes, kept)); }, act.dialog);
  },
  person: (seen, values) => act.save(seen, (notes) => Object.assign(notes, values)),
  trial: (seen, name, values) => act.save(seen, (notes) => {
    notes.trial = notes.trial || {};
    notes.trial[name] = Object.assign(notes.trial[name] || {}, values);
  }),
  async run(what) {
    await ask("run?" + query({ session: chosen, do: what }), { method: "POST" });
    await refresh();
  },
  async runAll(what) {
    await ask("run/all?" + query({ do: what }), { method: "POST" });
    await refresh();
  },
  // Copies the captures of each person into a session of their own, and shows the first of these.
  async separate() {
    const said = await ask("separate?" + query({ session: chosen }), { method: "POST" });
    await go(said.sessions[0]);
    tell(word("separated", said.sessions.length));
  },
  // Opens a view of the session, and puts it into the address.
  open(view, trial = null) {
    history.pushState(null, "", address({ session: chosen, view, trial }));
    act.view(view, trial);
  },
  view(view, trial) {
    const frame = (path, title) => element("iframe", { src: path, title });
    if (view === "session_report") sessionReport(chosen, act);
    else if (view === "help") act.dialog(word("help"), frame("help?" + query({ language }) + (trial ? `#${trial}` : ""), word("help")));
    else if (view === "live") new LiveDialog(chosen, act, trial).open();
    else if (view === "marker_set") act.dialog(word(view), frame("marker_set?" + query({ session: chosen, language }), word(view)));
    else {
      const asked = { session: chosen, trial, language }, kept = `trial/report?${query({ ...asked, save: 1 })}`;
      const save = element("a", { className: "button", href: kept, download: `${trial}.html` }, word("save"));
      act.dialog(trial, frame(`trial/${view}?` + query(asked), `${trial}: ${word(view)}`), view === "report" ? [save] : []);
    }
  },
  dialog(title, content, tools = []) {
    const dialog = element("dialog", { onclose: () => act.leave(dialog) });
    dialog.setAttribute("aria-label", title);
    dialog.opener = keyOf(document.activeElement);
    const close = element("button", { type: "button", onclick: () => dialog.close() }, word("close"));
    dialog.append(element("div", { className: "bar" }, element("b", {}, title), ...tools, close), content);
    document.body.append(dialog);
    dialog.showModal();
    placeMessages();
    return dialog;
  },
  // A dialog that the person closed leaves the address; one that the page closed has left it already.
  async leave(dialog) {
    if (!dialog.isConnected) return;
    dialog.remove();
    placeMessages();
    if (document.querySelector("dialog[open]")) return void focusKey(dialog.opener); // it lay over another one
    history.replaceState(null, "", address({ session: chosen }));
    await refresh();
    focusKey(dialog.opener);
  },
  report: () => act.open("session_report"),
  markerSet: () => act.open("marker_set"),
};

function draw(data, turn) {
  if (turn < drawn || data.id !== chosen) return; // a newer state is shown already, or another session
  drawn = turn;
  shown = data;
  document.title = `${titleOf(data.id)} · mbkf`;
  keepingFocus(() => { if (shown === data) drawParts(place("session"), data, act); }); // a drawing that waits may be an old one
}

const titleOf = (session) => (session === "." ? "·" : session);

// Shows a session as if nothing had been shown before.
function enter(session) {
  visit++;
  clearTimeout(timer);
  for (const dialog of document.querySelectorAll("dialog")) dialog.remove();
  placeMessages();
  [chosen, shown] = [session, null];
  told.textContent = "";
  document.title = "mbkf";
  forget();
}

function go(session) {
  history.pushState(null, "", address({ session }));
  enter(session);
  return refresh();
}

// Shows the session, the view and the trial of the address: at the start, after a reload, back and forward.
async function arrive() {
  const { session, view, trial } = addressed();
  enter(session);
  await refresh();
  if (shown && view) act.view(view, trial);
}

function lack(text) {
  forget();
  place("session").replaceChildren(element("p", { className: "lack" }, text));
}

// Waits for changes on their way: an answer without them would be taken for a newer one.
async function refresh() {
  await written.get(notesOf(chosen));
  const turn = ++turns, known = await ask("sessions");
  place("folder").textContent = known.folder;
  if (chosen === null && known.sessions.length) {
    chosen = known.sessions[0].id;
    history.replaceState(null, "", address({ session: chosen }));
  }
  keepingFocus(() => place("sessions").replaceChildren(dropZone(), ...allSessions(known.sessions, act), binList(known.moved, act)));
  if (chosen === null) lack(word("no_session"));
  else if (!known.sessions.some((one) => one.id === chosen)) {
    shown = null;
    lack(word("no_captures", chosen));
  } else {
    await ask(notesOf(chosen)).then((data) => draw(data, turn), (error) => {
      shown = null;
      lack(error.message);
    });
  }
  announce(queueText(known.sessions) || (shown ? runText(shown) : ""));
  clearTimeout(timer);
  if (known.sessions.some((one) => isBusy(one.run)) || (shown && isBusy(shown.run))) timer = setTimeout(refresh, AGAIN_MS);
}

function dropZone() {
  const pick = (folder) => {
    const input = element("input", { type: "file", multiple: true, hidden: true, webkitdirectory: folder });
    input.onchange = () => take([...input.files].map((file) => [file.webkitRelativePath || file.name, file]));
    const button = element("button", { type: "button", onclick: () => input.click() }, word(folder ? "choose_folder" : "choose_files"));
    button.dataset.key = `choose ${folder}`;
    return [button, input];
  };
  const zone = element("div", { className: "drop" }, word("drop"), " ", helpButton("add", act), element("div", { className: "choose" }, ...pick(true), ...pick(false)));
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
  const alone = kept.every(([path]) => !path.includes("/")), still = here();
  const refused = [];
  const into = alone ? `${shown && chosen !== "." ? chosen : "session"}/` : "";
  for (const [k, [path, file]] of kept.entries()) {
    if (still()) tell(word("uploading", k + 1, kept.length));
    try {
      await put(into + path, file);
    } catch (error) {
      refused.push(error.message);
    }
  }
  if (!still()) return refresh();
  if (kept.length) await go(await sessionOf(kept.map(([path]) => (into + path).split("/").slice(0, -1).join("/"))));
  if (refused.length) tell(word("not_taken", refused.length, refused[0]), true);
  else tell(word("uploaded", kept.length));
}

async function put(path, file) {
  const answer = await fetch("put?" + query({ file: path }), { method: "POST", body: file }).catch(() => null);
  if (answer === null) throw new Error(word("lost"));
  if (!answer.ok) throw new Error(troubleOf(await answer.json()));
}

// The first session of the list that is among the folders; the first folder without one, so that the page says so.
async function sessionOf(folders) {
  const { sessions } = await ask("sessions");
  return sessions.find((one) => folders.includes(one.id))?.id ?? folders[0];
}

function chooseLanguage() {
  const select = element("select", { onchange: () => { language = select.value; remember("mbkf language", language); start(); } },
    ...Object.keys(WORDS).map((name) => element("option", { value: name, selected: name === language }, WORDS[name].name)));
  place("language").replaceChildren(word("language") + " ", select);
}

function start() {
  document.documentElement.lang = language;
  place("sessions").setAttribute("aria-label", word("sessions"));
  place("help").replaceChildren(helpButton("", act));
  forget();
  chooseLanguage();
  arrive();
}

addEventListener("popstate", arrive);
addEventListener("pageshow", (event) => { if (event.persisted) arrive(); });

addEventListener("message", (event) => {
  if (event.origin === location.origin && event.data === "marker set done") document.querySelector("dialog[open]")?.close();
});

start();
