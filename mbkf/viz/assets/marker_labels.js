// Markers over the 3-D view: a dot for each where it is, its name at the nearer edge, and a line between the two.
"use strict";

class MarkerLabels {
  // view: the BodyScene; markers: entries of the page; look: {colour(marker), classes(marker), isChosen(marker), choose(marker), title(marker)}.
  constructor(view, markers, look) {
    [this.view, this.look, this.named, this.body] = [view, look, true, true];
    this.dots = document.getElementById("dots");
    this.lines = document.getElementById("lines");
    this.parts = markers.filter((marker) => marker.at).map((marker) => this.part(marker));
    this.caster = new view.THREE.Raycaster();
    this.seen = "";
    const draw = () => {
      requestAnimationFrame(draw);
      const now = this.camera();
      if (now !== this.seen) {
        this.seen = now;
        this.place();
      }
    };
    requestAnimationFrame(draw);
  }

  // A marker that has got a place.
  keep(marker) {
    if (!this.parts.some((part) => part.marker === marker)) this.parts.push(this.part(marker));
  }

  part(marker) {
    const told = (tag) => {
      const made = element("button", { type: "button" });
      made.dataset.marker = marker.name;
      made.dataset.part = tag;
      made.onclick = () => this.look.choose(marker);
      this.dots.append(made);
      return made;
    };
    const line = () => {
      const made = document.createElementNS("http://www.w3.org/2000/svg", "line");
      this.lines.append(made);
      return made;
    };
    const dot = told("dot"), tag = told("tag");
    tag.textContent = marker.name;
    dot.tabIndex = -1; // the name is there for the keyboard
    return { marker, dot, tag, line: line(), off: line() };
  }

  camera() {
    const { camera } = this.view.viewer, { clientWidth, clientHeight } = this.view.pane;
    return [...camera.matrixWorld.elements, camera.fov, clientWidth, clientHeight].join();
  }

  again() { this.seen = ""; }

  // Where a point of the world is on the screen.
  onScreen([x, y, z]) {
    const at = this.view.viewer.scene.localToWorld(new this.view.THREE.Vector3(x, y, z));
    const far = at.clone();
    at.project(this.view.viewer.camera);
    return { x: (at.x + 1) / 2 * this.view.pane.clientWidth, y: (1 - at.y) / 2 * this.view.pane.clientHeight, at: far, shown: at.z < 1 };
  }

  place() {
    const width = this.view.pane.clientWidth, height = this.view.pane.clientHeight;
    const spots = this.parts.map((part) => ({ ...part, ...this.onScreen(part.marker.at) }));
    const middle = this.middle(width);
    for (const spot of spots) this.paint(spot);
    for (const side of [-1, 1]) {
      const own = spots.filter((spot) => spot.shown && (spot.x < middle ? -1 : 1) === side).sort((a, b) => a.y - b.y);
      this.column(own, side, width, height);
    }
    for (const spot of spots.filter((one) => !one.shown)) for (const part of [spot.tag, spot.dot]) part.hidden = true;
  }

  // The body's own middle, so that names stand on the side of their limb.
  middle(width) {
    const pelvis = this.view.seenPelvis;
    return pelvis ? this.onScreen(pelvis).x : width / 2;
  }

  paint({ marker, dot, tag, line, off, x, y, at }) {
    const colour = this.look.colour(marker), classes = this.look.classes(marker), chosen = this.look.isChosen(marker);
    for (const [made, kind] of [[dot, "dot"], [tag, "tag"]]) {
      made.className = [kind, ...classes, chosen ? "chosen" : ""].join(" ");
      made.style.setProperty("--own", colour);
      made.dataset.segment = marker.segment;
      made.hidden = false;
      made.title = this.look.title(marker);
    }
    dot.classList.toggle("behind", this.hides(at));
    dot.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    line.setAttribute("stroke", colour);
    line.setAttribute("class", chosen ? "chosen" : "");
    const place = marker.seen && marker.place ? this.onScreen(marker.place) : null;
    const far = place && Math.hypot(place.x - x, place.y - y) > 9;
    this.draw(off, far ? [x, y, place.x, place.y] : null);
    off.setAttribute("stroke", colour);
    off.setAttribute("class", "off");
  }

  // Whether the body stands between the camera and a point.
  hides(at) {
    const { camera } = this.view.viewer, towards = at.clone().sub(camera.position), far = towards.length();
    this.caster.set(camera.position, towards.normalize());
    this.caster.far = far - 0.035;
    return this.body && this.caster.intersectObjects(this.view.segments, true).length > 0;
  }

  // Names one below the other at an edge, each as near to its marker's height as the others leave room.
  column(spots, side, width, height) {
    const room = height - 70, step = Math.min(18, room / Math.max(1, spots.length)), tight = step < 16;
    const ys = spots.map(({ y }) => y);
    for (let k = 1; k < ys.length; k++) ys[k] = Math.max(ys[k], ys[k - 1] + step);
    const last = height - 14;
    for (let k = ys.length - 1; k >= 0; k--) ys[k] = Math.min(ys[k], last - (ys.length - 1 - k) * step, k + 1 < ys.length ? ys[k + 1] - step : last);
    for (let k = 0; k < ys.length; k++) ys[k] = Math.max(ys[k], 56 + k * step);
    spots.forEach(({ marker, tag, line, x, y }, k) => {
      tag.hidden = !this.named && !this.look.isChosen(marker);
      tag.classList.toggle("rightward", side < 0);
      tag.classList.toggle("tight", tight);
      const wide = tag.offsetWidth, left = side < 0 ? Math.max(6, width * 0.02) : width - wide - Math.max(6, width * 0.02);
      tag.style.transform = `translate(${left.toFixed(1)}px, ${(ys[k] - 8).toFixed(1)}px)`;
      this.draw(line, tag.hidden ? null : [side < 0 ? left + wide : left, ys[k], x, y]);
    });
  }

  draw(line, ends) {
    line.style.display = ends ? "" : "none";
    if (ends) ["x1", "y1", "x2", "y2"].forEach((name, k) => line.setAttribute(name, ends[k].toFixed(1)));
  }
}
