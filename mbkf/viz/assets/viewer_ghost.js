// Another trial beside the one that is shown: its body half-transparent, its curves dashed.
"use strict";

const GHOST_OPACITY = 0.38;

// Strikes by which two trials are laid over each other: of the right foot if both have some, else of the left.
function strikesOf(mine, others) {
  const of = (events, side) => events.filter((one) => one.kind === "strike" && one.side === side).map((one) => one.time_s).sort((a, b) => a - b);
  for (const side of ["right", "left"]) {
    const [a, b] = [of(mine, side), of(others, side)];
    if (a.length && b.length) return [a, b];
  }
  return null;
}

class Ghost {
  // view: the 3-D view; recording: of the trial that is shown; data: the other trial's, from the server.
  static async of(view, recording, data) {
    return new Ghost(view, recording, data, await Recording.unpack(data.scene, data.rows));
  }

  constructor(view, recording, data, other) {
    Object.assign(this, { view, recording, other, scene: data.scene, events: data.events || data.found, mode: "cycle", strikes: null });
    this.quantities = new Map(data.scene.quantities.map((q) => [q.id, q]));
    this.cache = new Map();
    const T = view.THREE, skin = new T.MeshStandardMaterial({
      color: COLOURS.other, roughness: 0.8, transparent: true, opacity: GHOST_OPACITY, depthWrite: false,
      polygonOffset: true, polygonOffsetFactor: 4, polygonOffsetUnits: 100 });
    this.body = new T.Group();
    this.segments = data.scene.segments.map(({ shapes }) => {
      const group = new T.Group();
      for (const shape of shapes) group.add(new T.Mesh(view.geometry(shape), skin));
      this.body.add(group);
      return group;
    });
    view.viewer.scene.add(this.body);
  }

  remove() {
    this.view.viewer.scene.remove(this.body);
    this.view.viewer.set_dirty();
  }

  // mode: "cycle" or "time"; mine: the events of the trial that is shown. Whether cycles can be laid over each other.
  align(mode, mine) {
    this.strikes = mode === "cycle" ? strikesOf(mine, this.events) : null;
    this.cache.clear();
    return mode !== "cycle" || this.strikes !== null;
  }

  // The pair of strikes that holds at a time: the last one before it, and the other trial's with the same number.
  pair(time) {
    const [mine, others] = this.strikes;
    let k = 0;
    while (k + 1 < mine.length && mine[k + 1] <= time) k++;
    return [mine[k], others[Math.min(k, Math.max(0, others.length - 2))]];
  }

  timeAt(time) {
    if (!this.strikes) return this.other.times[0] + time - this.recording.times[0];
    const [mine, others] = this.pair(time);
    return others + time - mine;
  }

  static frameAt(recording, time) {
    return Math.round((time - recording.times[0]) / (recording.times[1] - recording.times[0] || 1));
  }

  static pelvis(recording, parts, time) {
    const frame = Math.min(recording.frames - 1, Math.max(0, Ghost.frameAt(recording, time)));
    const [px, py, , x, y, z, w] = recording.row(frame).subarray(parts.segments[0], parts.segments[0] + 7);
    return [px, py, Math.atan2(2 * (x * y + z * w), 1 - 2 * (y * y + z * z))];
  }

  show(time) {
    const frame = Ghost.frameAt(this.other, this.timeAt(time)), there = frame >= 0 && frame < this.other.frames;
    this.body.visible = there;
    if (there) {
      this.place(time);
      const row = this.other.row(frame), first = this.scene.parts.segments[0];
      this.segments.forEach((group, s) => {
        const p = first + 7 * s;
        group.visible = !Number.isNaN(row[p]);
        if (!group.visible) return;
        group.position.set(row[p], row[p + 1], row[p + 2]);
        group.quaternion.set(row[p + 3], row[p + 4], row[p + 5], row[p + 6]).normalize();
      });
    }
    this.view.viewer.set_dirty();
  }

  // Laid over each other by cycles, both pelves stand and face alike at the strike; by time, each stays in its place.
  place(time) {
    let [x, y, turn] = [0, 0, 0];
    if (this.strikes) {
      const [mine, others] = this.pair(time);
      const [ax, ay, at] = Ghost.pelvis(this.recording, this.view.parts, mine);
      const [bx, by, bt] = Ghost.pelvis(this.other, this.scene.parts, others);
      if (![ax, bx, at, bt].some(Number.isNaN)) {
        turn = at - bt;
        x = ax - (Math.cos(turn) * bx - Math.sin(turn) * by);
        y = ay - (Math.sin(turn) * bx + Math.cos(turn) * by);
      }
    }
    this.body.rotation.set(0, 0, turn);
    this.body.position.set(x, y, 0);
  }

  // A quantity of the other trial at the times of the one that is shown; null where it has none.
  series(q) {
    const own = this.quantities.get(q.id);
    if (!own) return null;
    if (!this.cache.has(q.id)) {
      const { values } = this.other.series(own), times = this.recording.times;
      const found = Float32Array.from(times, (time) => {
        const frame = Ghost.frameAt(this.other, this.timeAt(time));
        return frame >= 0 && frame < values.length ? values[frame] : NaN;
      });
      this.cache.set(q.id, { times, values: found });
    }
    return this.cache.get(q.id);
  }
}
