// The frame of both pages: header, 3-D view with its legend, plots, and a bar of controls.
"use strict";

const LEGEND = [
  ["body", "■", "#8fa0b0"], ["seen", "●", COLOURS.measured], ["predicted", "○", COLOURS.predicted],
  ["hidden", "◆", COLOURS.hidden], ["refused", "■", COLOURS.refused],
  ["unlabelled", "▲", COLOURS.unlabelled], ["reactions", "↑", COLOURS.axis], ["estimated", "⇡", COLOURS.axis],
];

class Page {
  constructor() {
    this.pane = document.getElementById("scene");
    this.column = document.getElementById("column");
    this.bar = document.getElementById("bar");
  }

  title(text) {
    document.getElementById("trial").textContent = text;
    document.title = `${text} · mbkf`;
  }

  legend(view) {
    const legend = document.getElementById("legend");
    for (const [what, sign, colour] of LEGEND) {
      if (what === "unlabelled" && !view.parts.unlabelled[1]) continue;
      const box = element("input", { type: "checkbox", checked: true });
      box.onchange = () => view.toggle(what, box.checked);
      const mark = element("i", { textContent: sign });
      mark.style.color = colour;
      legend.append(element("label", {}, box, mark, word(`legend_${what}`)));
    }
    const sides = element("span", { className: "sides" });
    for (const side of ["r", "l"]) {
      const mark = element("i", { textContent: "■" });
      mark.style.color = COLOURS[side];
      sides.append(mark, `${word(`side_${side}`)} `);
    }
    legend.append(sides);
    const views = document.getElementById("views");
    for (const from of ["oblique", "front", "right", "left", "back", "top"]) {
      const button = element("button", { textContent: word(`from_${from}`) });
      button.onclick = () => view.look(from);
      views.append(button);
    }
    const follow = element("input", { type: "checkbox", checked: true });
    follow.onchange = () => { view.follow = follow.checked; };
    views.append(element("label", {}, follow, word("follow")));
  }
}

async function start() {
  const page = new Page(), held = document.getElementById("recording");
  if (!held) {
    window.mbkf = new Live(page);
    return;
  }
  const { scene, rows } = JSON.parse(held.textContent);
  learn(scene.said);
  page.title(scene.title);
  window.mbkf = new Player(page, scene, await Recording.unpack(scene, rows));
}

function trouble(error) {
  document.getElementById("trouble").textContent = word("went_wrong", error.message);
}

addEventListener("error", trouble);
const started = start();
started.catch(trouble);
