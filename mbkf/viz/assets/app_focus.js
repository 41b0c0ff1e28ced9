// The focus stays where it is when parts of the page are drawn again: each control has a key, as has each menu.
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

// Draws, and gives focus and open menus back to the controls of the same keys.
function keepingFocus(drawAgain) {
  const focused = document.activeElement, key = keyOf(focused);
  const open = [...document.querySelectorAll("details[open] > summary")].map(keyOf);
  drawAgain();
  for (const one of document.querySelectorAll("details > summary")) if (open.includes(keyOf(one))) one.parentElement.open = true;
  if (key && !focused.isConnected) focusKey(key);
}
