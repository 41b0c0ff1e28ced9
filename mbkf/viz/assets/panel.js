// The column of plots: each shows a quantity chosen from a list, its present value, and a target band to train with.
"use strict";

const DEFAULTS = ["angle:knee_angle_r", "torque:ankle_angle_r", "reaction:vertical_r", "reaction:vertical_l"];

class Panel {
  // column: the element to fill; onSeek(time): called when a plot is clicked, or null.
  constructor(column, quantities, onSeek) {
    this.quantities = new Map(quantities.map((q) => [q.id, q]));
    this.onSeek = onSeek;
    this.cards = [];
    this.other = null; // gives a quantity's times and values in another trial, drawn dashed
    this.marks = []; // instants to mark: time, colour, dashed
    this.list = column.appendChild(element("div", { className: "plots" }));
    const add = element("button", { className: "add", textContent: word("add_plot") });
    add.onclick = () => this.add({ id: quantities[0].id });
    column.append(add);
    const kept = (remembered("mbkf-plots") || []).filter((choice) => this.quantities.has(choice.id));
    const first = DEFAULTS.filter((id) => this.quantities.has(id)).map((id) => ({ id }));
    for (const choice of kept.length ? kept : first) this.add(choice);
  }

  add({ id, low = "", high = "" }) {
    const card = { id, low, high };
    const choose = element("select", { title: word("quantity"), ariaLabel: word("quantity") });
    const groups = new Map();
    for (const q of this.quantities.values()) {
      if (!groups.has(q.group)) groups.set(q.group, choose.appendChild(element("optgroup", { label: spoken(q.group) })));
      groups.get(q.group).append(element("option", { value: q.id, textContent: spoken(q.title), selected: q.id === id }));
    }
    card.value = element("output", { className: "value", title: word("two_sd") });
    card.verdict = element("span", { className: "verdict" });
    card.canvas = element("canvas", { role: "img" });
    card.curve = new Curve(card.canvas);
    const bound = (name, label) => {
      const input = element("input", { type: "text", inputMode: "decimal", value: shownNumber(card[name]), placeholder: "–", ariaLabel: label });
      input.oninput = () => { card[name] = input.value.replace(",", "."); this.changed(); };
      return input;
    };
    card.unit = element("span", { className: "unit" });
    const remove = element("button", { className: "remove", textContent: "×", title: word("remove_plot") });
    card.positive = element("span", { className: "positive" });
    card.element = element("section", { className: "card" },
      element("div", { className: "head" }, choose, card.value, remove),
      card.canvas,
      element("div", { className: "foot" }, card.positive,
        element("label", { className: "target", title: word("band") }, word("target") + " ", bound("low", word("target_from")), ` ${word("to")} `, bound("high", word("target_to")), " ", card.unit), card.verdict));
    choose.onchange = () => { card.id = choose.value; card.low = card.high = ""; card.element.querySelectorAll("input").forEach((i) => { i.value = ""; }); this.changed(); };
    remove.onclick = () => { this.cards.splice(this.cards.indexOf(card), 1); card.element.remove(); this.changed(); };
    if (this.onSeek) {
      const seek = (event) => { if (event.buttons & 1) this.onSeek(card.curve.timeAt(event.clientX)); };
      card.canvas.onpointerdown = (event) => { card.canvas.setPointerCapture(event.pointerId); seek(event); };
      card.canvas.onpointermove = seek;
      card.canvas.style.cursor = "ew-resize";
    }
    this.cards.push(card);
    this.list.append(card.element);
    this.changed();
  }

  changed() {
    remember("mbkf-plots", this.cards.map(({ id, low, high }) => ({ id, low, high })));
    for (const card of this.cards) {
      const q = this.quantities.get(card.id);
      card.unit.textContent = spoken(q.unit);
      card.canvas.setAttribute("aria-label", spoken(q.title));
      card.positive.textContent = q.positive ? word("positive", spoken(q.positive)) : "";
    }
    if (this.onChange) this.onChange();
  }

  target(card) {
    const low = numberIn(String(card.low)), high = numberIn(String(card.high));
    if (Number.isNaN(low) || Number.isNaN(high)) return null;
    return low <= high ? [low, high] : [high, low];
  }

  // history.series(q) gives times, values and sds; row is the frame shown now, window the times, playhead a time or null.
  draw(history, row, window, playhead) {
    for (const card of this.cards) {
      const q = this.quantities.get(card.id), target = this.target(card), { times, values, sds } = history.series(q);
      card.curve.draw(times, values, sds, window, {
        colour: COLOURS[q.side], target, playhead, gap: history.gap, marks: this.marks, other: this.other && this.other(q) });
      this.tell(card, q, row, target);
    }
  }

  tell(card, q, row, target) {
    const value = row ? row[q.column] * q.factor : NaN, sd = row && q.sd_column >= 0 ? row[q.sd_column] * q.factor : NaN;
    const digits = Math.abs(value) >= 100 ? 0 : q.unit === "m" ? 3 : 1;
    const band = Number.isNaN(sd) ? "" : ` ± ${numeral(2 * sd, digits)}`, rounded = Number(value.toFixed(digits)) || 0;
    const shown = Number.isNaN(value) ? "–" : `${numeral(rounded, digits)}${band} ${spoken(q.unit)}`;
    if (card.value.textContent !== shown) card.value.textContent = shown;
    const where = !target || Number.isNaN(value) ? "" : value < target[0] ? "below" : value > target[1] ? "above" : "inside";
    card.element.dataset.target = where;
    const words = where && word(where);
    if (card.verdict.textContent !== words) card.verdict.textContent = words;
  }
}
