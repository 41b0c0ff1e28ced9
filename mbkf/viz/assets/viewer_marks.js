// Where loads press, in the 3-D view: a disc where a plate measures it, a ring where it is estimated.
"use strict";

const MEASURED = 1; // mbkf.io.contacts.Source: 0 none, 1 measured, 2 shared, 3 estimated

class PressureMarks {
  constructor(view, loads) {
    [this.view, this.parts, this.shown] = [view, view.parts, { measured: true, estimated: true }];
    this.marks = loads.map(({ side }) => ({ measured: this.mark(side, true), estimated: this.mark(side, false) }));
  }

  mark(side, measured) {
    const T = this.view.THREE, group = new T.Group();
    const flat = (geometry, color, order) => {
      const mesh = new T.Mesh(geometry, new T.MeshBasicMaterial({ color, depthTest: false, transparent: true, side: T.DoubleSide }));
      mesh.renderOrder = order;
      group.add(mesh);
    };
    if (measured) {
      flat(new T.CircleGeometry(0.045, 32), "#ffffff", 10);
      flat(new T.CircleGeometry(0.034, 32), COLOURS[side], 11);
    } else {
      flat(new T.RingGeometry(0.026, 0.056, 32), "#ffffff", 10);
      flat(new T.RingGeometry(0.034, 0.048, 32), COLOURS[side], 11);
    }
    group.visible = false;
    this.view.viewer.scene.add(group);
    return group;
  }

  show(row) {
    this.row = row;
    this.marks.forEach((mark, k) => {
      const p = this.parts.pressure[0] + 3 * k, how = Math.round(row[this.parts.source[0] + k]);
      const presses = how >= MEASURED && !Number.isNaN(row[p]);
      mark.measured.visible = presses && how === MEASURED && this.shown.measured;
      mark.estimated.visible = presses && how !== MEASURED && this.shown.estimated;
      for (const group of [mark.measured, mark.estimated]) group.position.set(row[p], row[p + 1], row[p + 2] + 0.004);
    });
    this.view.viewer.set_dirty();
  }

  // Entries of the legend, which hide and show them.
  legend(legend) {
    for (const [what, sign] of [["measured", "●"], ["estimated", "○"]]) {
      const box = element("input", { type: "checkbox", checked: true });
      box.onchange = () => { this.shown[what] = box.checked; if (this.row) this.show(this.row); };
      legend.append(element("label", {}, box, element("i", { textContent: sign }), word(`pressure_${what}`)));
    }
  }
}

// Stretches of frames in which a foot bears load and how that is known stays the same: first and last frame, measured.
function contactsOf(recording, parts, load) {
  const found = [];
  for (let t = 0; t < recording.frames; t++) {
    const how = Math.round(recording.rows[t * recording.width + parts.source[0] + load]) || 0;
    const last = found[found.length - 1];
    if (how < MEASURED) continue;
    if (last && last.to === t - 1 && last.measured === (how === MEASURED)) last.to = t;
    else found.push({ from: t, to: t, measured: how === MEASURED });
  }
  return found;
}
