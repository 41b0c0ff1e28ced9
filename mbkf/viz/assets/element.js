// A document element with its attributes and children, in one call; and a phrase in the page's language.
"use strict";

function element(tag, attributes = {}, ...children) {
  const made = Object.assign(document.createElement(tag), attributes);
  made.append(...children);
  return made;
}

// A page without words of its own (app_words.js) speaks English.
function phrase(name, english, ...values) {
  const text = typeof word === "function" ? word(name, ...values) : english;
  return values.reduce((said, value, k) => said.replace(`{${k}}`, value), text);
}
