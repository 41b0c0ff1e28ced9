// Strikes and toe-offs of a trial: the found ones until a person changes one, then all are by hand; with undo.
"use strict";

const MERGE_MS = 1200; // moves of one event that follow each other as fast are undone at once

class FootEvents {
  // found, byHand: lists of {side, kind, time_s}; byHand is null where nothing was set. span: first and last time.
  constructor(found, byHand, span) {
    this.next = 0;
    const keyed = (list) => list.map((one) => ({ ...one, key: this.next++ }));
    Object.assign(this, { found: keyed(found), list: byHand && keyed(byHand), span, past: [], future: [], moved: null, mergeMs: MERGE_MS, onChange: null });
  }

  get byHand() {
    return this.list !== null;
  }

  get shown() {
    return this.list || this.found;
  }

  of(side) {
    return this.shown.filter((one) => one.side === side).sort((a, b) => a.time_s - b.time_s || a.kind.localeCompare(b.kind));
  }

  // Neighbours of one foot that do not alternate: strike, toe-off, strike.
  outOfOrder() {
    return ["right", "left"].flatMap((side) => {
      const lane = this.of(side);
      return lane.slice(1).map((one, k) => ({ side, kind: one.kind, from: lane[k], to: one })).filter(({ from, to }) => from.kind === to.kind);
    });
  }

  get(key) {
    return this.shown.find((one) => one.key === key);
  }

  within(time) {
    return Math.min(this.span[1], Math.max(this.span[0], time));
  }

  set(list, keepPast = false) {
    if (!keepPast) this.past.push(this.list);
    this.list = list;
    this.future = [];
    if (this.onChange) this.onChange();
  }

  add(side, kind, time) {
    const key = this.next++;
    this.moved = null;
    this.set([...this.shown, { side, kind, time_s: this.within(time), key }]);
    return key;
  }

  move(key, time) {
    const to = this.within(time), now = performance.now();
    if (to === this.get(key).time_s) return;
    const again = this.moved && this.moved.key === key && now - this.moved.at < this.mergeMs;
    this.moved = { key, at: now };
    this.set(this.shown.map((one) => (one.key === key ? { ...one, time_s: to } : one)), again);
  }

  remove(key) {
    this.moved = null;
    this.set(this.shown.filter((one) => one.key !== key));
  }

  // Back to the found ones.
  forget() {
    this.moved = null;
    this.set(null);
  }

  // Takes events as the server gives them, without telling of a change.
  put(list) {
    this.past.push(this.list);
    this.list = list && list.map((one) => ({ ...one, key: this.next++ }));
    [this.future, this.moved] = [[], null];
  }

  step(from, to) {
    if (!from.length) return;
    to.push(this.list);
    this.list = from.pop();
    this.moved = null;
    if (this.onChange) this.onChange();
  }

  undo() {
    this.step(this.past, this.future);
  }

  redo() {
    this.step(this.future, this.past);
  }

  // As the server takes them; null for the found ones.
  plain() {
    return this.list && this.list.map(({ side, kind, time_s }) => ({ side, kind, time_s })).sort((a, b) => a.time_s - b.time_s);
  }
}
