// Focus, open menus and clicks outlast a part of the page being drawn again: each control has a key, as has each menu.
"use strict";

const CONTROLS = "input, select, button, summary, textarea, a[href]";

const keyOf = (one) => (one && one.dataset && one.dataset.key) || null;

// Gives the controls of a part keys of their own; those that have one keep it.
function keyed(part, name) {
  const counts = new Map();
  for (const one of part.querySelectorAll(CONTROLS)) {
    if (keyOf(one)) continue;
    const own = `${name} ${one.tagName} ${one.name || one.className || one.ariaLabel || one.textContent}`, count = counts.get(own) || 0;
    counts.set(own, count + 1);
    one.dataset.key = `${own} ${count}`;
  }
  return part;
}

function focusKey(key) {
  const found = key && document.querySelector(`[data-key="${CSS.escape(key)}"]`);
  if (found) found.focus({ preventScroll: true });
  return Boolean(found);
}

let waiting = null; // drawings while a pointer or a key is pressed; null while nothing is

// A click needs the control that was pressed to be there at the release, so drawings wait for it.
function hold() {
  waiting = waiting || [];
}

function release() {
  const drawings = waiting || [];
  waiting = null;
  drawings.forEach(keepingFocus);
}

const afterClick = () => { if (waiting) setTimeout(release); };
addEventListener("pointerdown", hold, true);
addEventListener("keydown", (event) => { if (event.key === " ") hold(); }, true);
for (const end of ["pointerup", "pointercancel", "keyup"]) addEventListener(end, afterClick, true);
addEventListener("blur", afterClick); // the window's own: a press takes the focus from another control
addEventListener("pointermove", (event) => { if (!event.buttons) afterClick(); }, true); // released over an open list or another window

// Draws, and gives focus, open and closed menus back to the controls of the same keys.
function keepingFocus(drawAgain) {
  if (waiting) return void waiting.push(drawAgain);
  const focused = document.activeElement, key = keyOf(focused);
  const summaries = () => document.querySelectorAll("details > summary[data-key]");
  const open = new Map([...summaries()].map((one) => [keyOf(one), one.parentElement.open]));
  drawAgain();
  for (const one of summaries()) one.parentElement.open = open.get(keyOf(one)) ?? one.parentElement.open;
  if (key && !focused.isConnected) focusKey(key);
}
