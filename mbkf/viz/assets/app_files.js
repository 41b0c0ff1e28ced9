// Sessions and trials renamed, moved and deleted, the bin that gives them back, and the menus that offer it.
"use strict";

// A button that opens a list of others; Escape and a click elsewhere close it. entries: pairs of text and act.
function menu(text, label, entries) {
  const opener = element("summary", {}, text), list = element("div", { className: "entries" });
  opener.setAttribute("aria-label", label);
  opener.dataset.key = `menu ${label}`;
  const made = element("details", { className: "menu" }, opener, list);
  const close = () => { made.open = false; };
  list.append(...entries.map(([title, act]) => {
    const entry = element("button", { type: "button", onclick: () => { close(); opener.focus(); act(); } }, title);
    entry.dataset.key = `${label} ${title}`;
    return entry;
  }));
  made.onkeydown = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key], stops = [opener, ...list.children];
    if (event.key === "Escape" && made.open) {
      close();
      opener.focus();
    } else if (step && made.open) stops[(stops.indexOf(document.activeElement) + step + stops.length) % stops.length].focus();
    else return;
    event.preventDefault();
  };
  made.addEventListener("focusout", (event) => { if (event.relatedTarget && !made.contains(event.relatedTarget)) close(); });
  return made;
}

addEventListener("pointerdown", (event) => {
  for (const one of document.querySelectorAll("details.menu[open]")) if (!one.contains(event.target)) one.open = false;
});

function helpButton(section, act, text = "?") {
  const label = section && text === "?" ? word("help_on", word(`help_${section}`)) : text === "?" ? word("help") : text;
  const button = element("button", { type: "button", className: "help", onclick: () => act.open("help", section || null) }, section ? text : word("help"));
  button.setAttribute("aria-label", label);
  button.dataset.key = `help ${section}`;
  return button;
}

function filesMenu(session, trial, act, more = [], recorded = false) {
  const entries = [...more];
  if (!recorded) entries.push([word("rename"), () => renameDialog(session, trial, act)]);
  entries.push([word("delete"), () => arrange({ do: "delete", session, trial }, word("deleted", trial || session), act)]);
  return menu("⋯", word("files_of", trial || session), entries);
}

// Carries out, says it, and offers to take it back.
async function arrange(wanted, done, act) {
  const said = await ask("arrange?" + query(wanted), { method: "POST" });
  if (wanted.trial) await refresh();
  else await go(wanted.do === "delete" ? null : said.session);
  const undo = element("button", { type: "button", onclick: () => putBack(said.key, act) }, word("undo"));
  tell(done, false, undo);
  undo.focus();
}

async function putBack(key) {
  const said = await ask("arrange?" + query({ do: "undo", key }), { method: "POST" });
  await go(said.session);
  tell(word("undone", said.trial || said.session));
  if (said.trial) focusKey(`menu ${word("files_of", said.trial)}`);
  else focusKey(`session ${said.session}`);
}

function renameDialog(session, trial, act) {
  const name = element("input", { name: "name", type: "text", value: trial || session, required: true, autocomplete: "off", spellcheck: false });
  const into = element("input", { name: "session", type: "text", value: session, required: true, autocomplete: "off", spellcheck: false });
  into.setAttribute("list", "known-sessions");
  const known = [...document.querySelectorAll("button.session span:first-child")].map((one) => one.textContent);
  const fields = trial ? [field(word("trial_name"), name), field(word("in_session"), into), element("datalist", { id: "known-sessions" }, ...known.map((value) => element("option", { value })))] : [field(word("session_name"), name)];
  const wrong = element("p", { className: "wrong", role: "alert" });
  const form = element("form", { className: "rename" }, ...fields, element("p", { className: "note" }, word(trial ? "rename_trial_note" : "rename_session_note")), wrong, element("button", { className: "main" }, word("rename_do")));
  const dialog = act.dialog(`${word("rename")} ${trial || session}`, form);
  dialog.classList.add("small");
  form.onsubmit = async (event) => {
    event.preventDefault();
    wrong.textContent = [name, ...(trial ? [into] : [])].map((one) => nameFault(one.value.trim(), one === name && Boolean(trial))).find(Boolean) || "";
    if (wrong.textContent) return;
    const to = trial ? { to_session: into.value.trim(), to_trial: name.value.trim() } : { to_session: name.value.trim() };
    try {
      const wanted = { do: "move", session, trial, ...to };
      const answer = await fetch("arrange?" + query(wanted), { method: "POST" }), said = await answer.json();
      if (!answer.ok) throw new Error(troubleOf(said));
      dialog.remove();
      if (!trial || to.to_session !== session) await go(trial ? to.to_session : said.session);
      else await refresh();
      const undo = element("button", { type: "button", onclick: () => putBack(said.key, act) }, word("undo"));
      tell(word("renamed", trial || session, trial ? `${to.to_session} · ${to.to_trial}` : to.to_session), false, undo);
      undo.focus();
    } catch (error) {
      wrong.textContent = error instanceof TypeError ? word("lost") : error.message;
    }
  };
  name.select();
}

const FORBIDDEN = /[\\:*?"<>|\u0000-\u001f]/;

// The reason that a name is not possible; empty for one that is. The server looks again.
function nameFault(name, plain) {
  if (!name) return word("name_missing");
  if (FORBIDDEN.test(name) || (plain && name.includes("/")) || (name !== "." && name.split("/").some((part) => !part || part.startsWith(".")))) return word("name_wrong", name);
  return "";
}

// All that can be taken back, the newest first.
function binList(moved, act) {
  if (!moved.length) return "";
  const opener = element("summary", {}, word("bin", moved.length));
  opener.dataset.key = "bin";
  const title = (session, trial) => (trial ? `${session} · ${trial}` : session);
  return element("details", { className: "bin" }, opener, element("ul", {}, ...moved.map((one) => {
    const before = title(one.session, one.trial), after = title(one.to_session, one.to_trial);
    const text = one.act === "delete" ? word("bin_deleted", before) : word("bin_moved", before, after);
    const back = element("button", { type: "button", onclick: () => putBack(one.key, act) }, word(one.act === "delete" ? "restore" : "undo"));
    back.setAttribute("aria-label", `${word(one.act === "delete" ? "restore" : "undo")}: ${text}`);
    back.dataset.key = `bin ${one.key}`;
    return element("li", {}, element("span", {}, text), element("small", {}, new Date(1000 * one.at_s).toLocaleString(language)), back);
  })));
}
