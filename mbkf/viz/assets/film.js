// A film of the 3-D view: a picture of any frame when it is asked for, not in real time, with what it shows and when.
// Evaluated in the playback page, whose player it takes over.
"use strict";

window.film = {
  begin([width, height, title]) {
    if (!window.mbkf) throw new Error(document.getElementById("trouble").textContent);
    const { view, recording } = window.mbkf, canvas = element("canvas", { width, height });
    Object.assign(view.pane.style, { position: "fixed", inset: "0 auto auto 0", width: `${width}px`, height: `${height}px` });
    view.viewer.renderer.setPixelRatio(1);
    view.resize();
    Object.assign(this, { view, recording, canvas, title, g: canvas.getContext("2d"), letter: Math.round(height / 30) });
  },

  // A picture as an address of PNG data; the view's own canvas holds it only until the script ends.
  picture([frame, time]) {
    const { view, recording, canvas, title, g, letter } = this, row = recording.row(frame);
    view.show(row);
    view.placeMarkers(row);
    view.viewer.render();
    g.drawImage(view.viewer.renderer.domElement, 0, 0, canvas.width, canvas.height);
    g.font = `${letter}px system-ui, sans-serif`;
    g.fillStyle = "#24303d";
    g.textAlign = "left";
    g.fillText(title, letter, canvas.height - letter, 0.7 * canvas.width);
    g.textAlign = "right";
    g.fillText(`${time.toFixed(2)} s`, canvas.width - letter, canvas.height - letter);
    return canvas.toDataURL("image/png");
  },
};
