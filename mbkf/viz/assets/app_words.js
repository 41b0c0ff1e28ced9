// The page's words in the language that was chosen, which the browser remembers; WORDS comes from the language files.
"use strict";

const WORDS = JSON.parse(document.getElementById("words").textContent);

function remembered(key) {
  try {
    return JSON.parse(localStorage.getItem(key));
  } catch {
    return null;
  }
}

function remember(key, value) {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch { /* a page opened from a file or written into a window may have no storage */ }
}

const known = (name) => (name in WORDS ? name : null);
let language = known(new URLSearchParams(location.search).get("language")) || known(remembered("mbkf language")) || known(navigator.language.slice(0, 2)) || "en";

// Every request states the language that the page is read in, so that the server's sentences come in it.
const fetchPlain = window.fetch.bind(window);
window.fetch = (path, options = {}) => fetchPlain(path, { ...options, headers: { "Accept-Language": language, ...options.headers } });

// A number with the language's decimal sign, and the number that a person wrote with either sign; NaN of another text.
const numeral = (value, digits) => value.toFixed(digits).replace(".", WORDS[language].decimal).replace("-", "−");
const numberIn = (text) => (text.trim() === "" ? NaN : Number(text.trim().replace(",", ".").replace("−", "-")));
const shownNumber = (value) => String(value ?? "").replace(/^(-?\d+)\.(\d+)$/, `$1${WORDS[language].decimal}$2`);

// Sentences of the library in other languages, as the server sends them beside its data.
const SAID = {};

function learn(sentences = {}) {
  for (const [code, known] of Object.entries(sentences)) SAID[code] = { ...SAID[code], ...known };
}

const spoken = (text) => SAID[language]?.[text] ?? text;

function word(name, ...values) {
  return WORDS[language].words[name].replace(/\{(\d)\}/g, (_, k) => values[k]); // whatever signs the values hold
}

function duration(seconds) {
  return seconds < 90 ? word("seconds", Math.max(1, Math.round(seconds))) : word("minutes", Math.round(seconds / 60));
}
