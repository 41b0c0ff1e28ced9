// The place of the page: session, view and trial stand in the address, so that reload and back land where they were.
"use strict";

// Counts the sessions that were shown: replies that come after the page has moved on are dropped, its messages end.
let visit = 0;

const VIEWS = ["look", "report", "session_report", "marker_set", "live", "help"];

const here = () => {
  const at = visit;
  return () => at === visit;
};

function addressed() {
  const words = new URLSearchParams(location.search), view = words.get("view");
  return { session: words.get("session"), view: VIEWS.includes(view) ? view : null, trial: words.get("trial") };
}

function address({ session, view, trial }) {
  const words = Object.entries({ session, view, trial }).filter(([, value]) => value !== null && value !== undefined);
  return words.length ? "?" + new URLSearchParams(words) : location.pathname;
}

// A reply for a session that is shown no more never arrives: whoever waits for it does nothing further.
function whileHere(still, value) {
  return still() ? value : new Promise(() => {});
}
