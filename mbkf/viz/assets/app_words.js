// The page's words in the language that was chosen; WORDS comes from the language files.
"use strict";

const WORDS = JSON.parse(document.getElementById("words").textContent);

const known = (name) => (name in WORDS ? name : null);
let language = known(localStorage.getItem("mbkf language")) || known(navigator.language.slice(0, 2)) || "en";

function word(name, ...values) {
  return WORDS[language].words[name].replace(/\{(\d)\}/g, (_, k) => values[k]); // whatever signs the values hold
}

function duration(seconds) {
  return seconds < 90 ? word("seconds", Math.max(1, Math.round(seconds))) : word("minutes", Math.round(seconds / 60));
}
