// The 3-D scene: a person of 18 segments, markers, reactions, plates and floor, drawn by meshcat's viewer.
// World axes: x forward, y left, z up; metres.
"use strict";

class BodyScene {
  // pane: the element to fill; description: the page's first message (mbkf/viz/scene/description.py).
  constructor(pane, description) {
    this.pane = pane;
    this.THREE = MeshCat.THREE;
    this.parts = description.parts;
    this.names = description.markers;
    this.segmentCount = description.segments.length;
    this.newtonPerMetre = 1.1 * description.weight_n;
    this.follow = true;
    this.seenPelvis = null;
    this.startViewer();
    this.addLight();
    this.addFloor(description.plates);
    this.addBody(description.segments);
    this.addMarkers();
    this.addLoads(description.loads);
    new ResizeObserver(() => this.resize()).observe(pane);
    this.resize();
  }

  startViewer() {
    const viewer = new MeshCat.Viewer(this.pane, false);
    this.viewer = viewer;
    viewer.set_3d_pane_size = () => this.resize();
    viewer.gui.domElement.remove();
    viewer.set_property(["Background"], "top_color", [0.93, 0.95, 0.97]);
    viewer.set_property(["Background"], "bottom_color", [1, 1, 1]);
    for (const name of ["Axes", "Grid", "Lights"]) viewer.set_property([name], "visible", false);
    viewer.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    viewer.camera.fov = 30;
    viewer.controls.screenSpacePanning = true;
    viewer.controls.maxDistance = 30;
    const canvas = viewer.renderer.domElement;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", word("scene"));
    const draw = () => {
      requestAnimationFrame(draw);
      if (!viewer.needs_render) return;
      if (this.row) this.placeMarkers(this.row); // they face the camera, wherever that has moved
      viewer.render();
    };
    requestAnimationFrame(draw);
    this.look("oblique");
  }

  resize() {
    const width = this.pane.clientWidth, height = this.pane.clientHeight;
    if (!width || !height) return;
    this.viewer.camera.aspect = width / height;
    this.viewer.camera.updateProjectionMatrix();
    this.viewer.renderer.setSize(width, height);
    this.viewer.set_dirty();
  }

  // meshcat turns its scene: the camera's axes are y up, and the world's (x, y, z) are its (x, z, −y).
  look(from) {
    const directions = {
      oblique: [0.72, -0.95, 0.32], front: [1, 0, 0.08], right: [0, -1, 0.08], left: [0, 1, 0.08],
      back: [-1, 0, 0.08], top: [0.001, 0, 1],
    };
    const [x, y, z] = directions[from], n = Math.hypot(x, y, z), far = 4.6 / n;
    const at = this.seenPelvis || [0, 0, 0];
    const target = this.viewer.controls.target;
    target.set(at[0], 0.88, -at[1]);
    this.viewer.camera.position.set(target.x + x * far, target.y + z * far, target.z - y * far);
    this.viewer.controls.update();
    this.viewer.set_dirty();
  }

  addLight() {
    const T = this.THREE, scene = this.viewer.scene;
    scene.add(new T.HemisphereLight(0xffffff, 0xc9d1da, 0.78));
    const sun = new T.DirectionalLight(0xffffff, 0.55);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    Object.assign(sun.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 0.5, far: 9 });
    sun.shadow.bias = -0.0008;
    scene.add(sun, sun.target);
    this.sun = sun;
    this.shine([0, 0]);
  }

  shine([x, y]) {
    this.sun.position.set(x + 1.3, y - 1.7, 4.6);
    this.sun.target.position.set(x, y, 0.6);
  }

  addFloor(plates) {
    const T = this.THREE, scene = this.viewer.scene;
    const shade = new T.Mesh(new T.PlaneGeometry(40, 40), new T.ShadowMaterial({ opacity: 0.16 }));
    shade.receiveShadow = true;
    shade.position.z = 0.001;
    scene.fog = new T.Fog(0xf7f9fb, 6, 15);
    const floor = new T.Mesh(new T.PlaneGeometry(60, 60), new T.MeshBasicMaterial({ map: this.gridTexture(60) }));
    floor.position.z = -0.002;
    scene.add(floor);
    scene.add(shade);
    for (const corners of plates) {
      const outline = new T.BufferGeometry().setFromPoints(corners.map((c) => new T.Vector3(c[0], c[1], c[2] + 0.003)));
      scene.add(new T.LineLoop(outline, new T.LineBasicMaterial({ color: 0x6f8194 })));
      const face = new T.BufferGeometry().setFromPoints(
        [0, 1, 2, 0, 2, 3].map((i) => new T.Vector3(corners[i][0], corners[i][1], corners[i][2] + 0.002)));
      scene.add(new T.Mesh(face, new T.MeshBasicMaterial({
        color: 0x9fb2c4, transparent: true, opacity: 0.38, side: T.DoubleSide, depthWrite: false })));
    }
  }

  // Squares of half a metre, a stronger line every metre.
  gridTexture(repeat) {
    const T = this.THREE, size = 512, canvas = element("canvas", { width: size, height: size }), g = canvas.getContext("2d");
    g.fillStyle = "#fbfcfd";
    g.fillRect(0, 0, size, size);
    for (const [at, colour, width] of [[size / 2, "#e2e8ee", 3], [0, "#c9d3dc", 6], [size, "#c9d3dc", 6]]) {
      [g.strokeStyle, g.lineWidth] = [colour, width];
      for (const [x0, y0, x1, y1] of [[at, 0, at, size], [0, at, size, at]]) {
        g.beginPath();
        g.moveTo(x0, y0);
        g.lineTo(x1, y1);
        g.stroke();
      }
    }
    const texture = new T.CanvasTexture(canvas);
    texture.wrapS = texture.wrapT = T.RepeatWrapping;
    texture.repeat.set(repeat, repeat);
    texture.anisotropy = this.viewer.renderer.capabilities.getMaxAnisotropy();
    return texture;
  }

  addBody(segments) {
    const T = this.THREE;
    this.segments = segments.map(({ name, shapes }) => {
      const group = new T.Group();
      const colour = new T.Color(0xb9c4cf);
      if (name.startsWith("right_")) colour.lerp(new T.Color(COLOURS.r), 0.3);
      if (name.startsWith("left_")) colour.lerp(new T.Color(COLOURS.l), 0.3);
      const skin = new T.MeshStandardMaterial({ color: colour, roughness: 0.75 });
      for (const shape of shapes) {
        const mesh = new T.Mesh(this.geometry(shape), skin);
        mesh.castShadow = true;
        group.add(mesh);
      }
      group.visible = false;
      this.viewer.scene.add(group);
      return group;
    });
  }

  geometry({ kind, numbers: n }) {
    const T = this.THREE;
    if (kind === "ellipsoid") return new T.SphereGeometry(1, 36, 24).scale(n[3], n[4], n[5]).translate(n[0], n[1], n[2]);
    return { limb: this.limb, tube: this.tube, outline: this.outline }[kind].call(this, n);
  }

  limb(n) {
    const T = this.THREE, [r0, r1] = [n[6], n[7]];
    const from = new T.Vector3(n[0], n[1], n[2]), to = new T.Vector3(n[3], n[4], n[5]);
    const length = from.distanceTo(to), profile = [];
    for (let i = 0; i <= 8; i++) profile.push(new T.Vector2(r0 * Math.sin((i / 8) * Math.PI / 2), -r0 * Math.cos((i / 8) * Math.PI / 2)));
    for (let i = 1; i < 8; i++) {
      const s = i / 8;
      profile.push(new T.Vector2(r0 + (r1 - r0) * s + 0.10 * r0 * Math.sin(Math.PI * Math.sqrt(s)), length * s));
    }
    for (let i = 0; i <= 8; i++) profile.push(new T.Vector2(r1 * Math.cos((i / 8) * Math.PI / 2), length + r1 * Math.sin((i / 8) * Math.PI / 2)));
    const turn = new T.Quaternion().setFromUnitVectors(new T.Vector3(0, 1, 0), to.clone().sub(from).normalize());
    return new T.LatheGeometry(profile, 28).applyQuaternion(turn).translate(from.x, from.y, from.z);
  }

  // Elliptic sections one above the other, rounded in between: x, z, half depth, half breadth each.
  tube(given) {
    const T = this.THREE, n = this.rounded(given, 4), sections = n.length / 4, made = new T.CylinderGeometry(1, 1, 1, 40, sections - 1, true);
    const at = made.attributes.position;
    for (let i = 0; i < at.count; i++) {
      const k = 4 * (sections - 1 - Math.floor(i / 41));
      at.setXYZ(i, n[k] + n[k + 2] * at.getX(i), n[k + 3] * at.getZ(i), n[k + 1]);
    }
    const order = made.index.array;
    for (let i = 0; i < order.length; i += 3) [order[i], order[i + 1]] = [order[i + 1], order[i]];
    made.computeVertexNormals();
    return made;
  }

  // Catmull and Rom's curve through points of four numbers, each stretch in so many parts.
  rounded(n, parts) {
    const last = n.length / 4 - 1, found = [];
    const at = (k, i) => n[4 * Math.min(last, Math.max(0, k)) + i];
    for (let k = 0; k < last; k++) {
      for (let part = 0; part < parts; part++) {
        const s = part / parts;
        for (let i = 0; i < 4; i++) {
          const [a, b, c, d] = [at(k - 1, i), at(k, i), at(k + 1, i), at(k + 2, i)];
          found.push(b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a))));
        }
      }
    }
    return found.concat(n.slice(-4));
  }

  outline(n) {
    const T = this.THREE, bevel = 0.010, side = new T.Shape();
    for (let i = 2; i < n.length; i += 2) side[i === 2 ? "moveTo" : "lineTo"](n[i], n[i + 1]);
    const depth = n[1] - n[0] - 2 * bevel;
    const solid = new T.ExtrudeGeometry(side, { depth, bevelSize: bevel / 2, bevelThickness: bevel, bevelSegments: 4 });
    return solid.translate(0, 0, -n[1] + bevel).applyMatrix4(new T.Matrix4().makeRotationX(Math.PI / 2));
  }

  addMarkers() {
    const T = this.THREE, count = Math.max(1, this.names.length);
    const make = (geometry, colour, size) => {
      const mesh = new T.InstancedMesh(geometry, new T.MeshBasicMaterial({ color: colour }), size);
      const behind = new T.InstancedMesh(geometry, mesh.material.clone(), size); // faint where the body hides it
      Object.assign(behind.material, { transparent: true, opacity: 0.3, depthTest: false });
      behind.instanceMatrix = mesh.instanceMatrix;
      mesh.behind = behind;
      mesh.frustumCulled = behind.frustumCulled = false;
      mesh.count = behind.count = 0;
      this.viewer.scene.add(mesh, behind);
      return mesh;
    };
    const [, unlabelled] = this.parts.unlabelled;
    this.markers = {
      seen: make(new T.SphereGeometry(0.0105, 14, 10), COLOURS.measured, count),
      predicted: make(new T.TorusGeometry(0.0155, 0.0028, 6, 20), COLOURS.predicted, count),
      hidden: make(new T.OctahedronGeometry(0.023), COLOURS.hidden, count),
      refused: make(new T.BoxGeometry(0.024, 0.024, 0.024), COLOURS.refused, count),
      unlabelled: make(new T.TetrahedronGeometry(0.014), COLOURS.unlabelled, Math.max(1, unlabelled / 3)),
    };
    this.shown = { body: true, seen: true, predicted: true, hidden: true, refused: true, unlabelled: true, reactions: true, estimated: true };
  }

  // An arrow for each load: its shaft is whole where a plate measures the force, dashed where it is estimated.
  addLoads(loads) {
    const T = this.THREE, dashes = 6;
    const bar = (from, to) => new T.CylinderGeometry(0.011, 0.011, to - from, 16).translate(0, (from + to) / 2, 0);
    this.arrows = loads.map(({ side }) => {
      const arrow = new T.Group(), solid = new T.MeshStandardMaterial({ color: COLOURS[side], roughness: 0.6 });
      const faint = new T.MeshBasicMaterial({ color: COLOURS[side], transparent: true, opacity: 0.35, depthTest: false });
      const pair = (geometry) => new T.Group().add(new T.Mesh(geometry, solid), new T.Mesh(geometry, faint));
      const whole = pair(bar(0, 1)), dashed = new T.Group();
      for (let k = 0; k < dashes; k++) dashed.add(pair(bar(k / dashes, (k + 0.55) / dashes)));
      const head = pair(new T.ConeGeometry(0.032, 0.09, 20).translate(0, 0.045, 0));
      arrow.add(whole, dashed, head);
      arrow.visible = false;
      this.viewer.scene.add(arrow);
      return { arrow, whole, dashed, head };
    });
  }

  show(row) {
    this.row = row;
    this.placeSegments(row);
    this.placeLoads(row);
    this.viewer.set_dirty();
  }

  toggle(what, on) {
    this.shown[what] = on;
    if (this.row) this.show(this.row);
  }

  placeSegments(row) {
    const first = this.parts.segments[0];
    this.segments.forEach((group, s) => {
      const p = first + 7 * s, known = !Number.isNaN(row[p]);
      group.visible = known && this.shown.body;
      if (!known) return;
      group.position.set(row[p], row[p + 1], row[p + 2]);
      group.quaternion.set(row[p + 3], row[p + 4], row[p + 5], row[p + 6]).normalize();
    });
    if (Number.isNaN(row[first])) return;
    const pelvis = [row[first], row[first + 1], row[first + 2]];
    if (this.follow && this.seenPelvis) this.moveCamera(pelvis[0] - this.seenPelvis[0], pelvis[1] - this.seenPelvis[1]);
    const start = !this.seenPelvis;
    this.seenPelvis = pelvis;
    this.shine(pelvis);
    if (start) this.look("oblique");
  }

  moveCamera(dx, dy) {
    const { camera, controls } = this.viewer;
    for (const point of [camera.position, controls.target]) point.set(point.x + dx, point.y, point.z - dy);
  }

  placeMarkers(row) {
    const T = this.THREE, at = new T.Matrix4(), facing = new T.Quaternion(), one = new T.Vector3(1, 1, 1), place = new T.Vector3();
    for (const mesh of Object.values(this.markers)) mesh.count = 0;
    this.viewer.camera.getWorldQuaternion(facing);
    facing.premultiply(this.viewer.scene.quaternion.clone().invert());
    const put = (name, p) => {
      const mesh = this.markers[name];
      if (!this.shown[name] || Number.isNaN(row[p])) return;
      place.set(row[p], row[p + 1], row[p + 2]);
      mesh.setMatrixAt(mesh.count++, at.compose(place, facing, one));
    };
    const { measured, predicted, state, unlabelled } = this.parts;
    for (let m = 0; m < this.names.length; m++) {
      const how = Math.round(row[state[0] + m]);
      if (how === 0) put("seen", measured[0] + 3 * m);
      if (how === 2) put("refused", measured[0] + 3 * m);
      put(how === 1 ? "hidden" : "predicted", predicted[0] + 3 * m);
    }
    for (let u = 0; u < unlabelled[1]; u += 3) put("unlabelled", unlabelled[0] + u);
    for (const mesh of Object.values(this.markers)) {
      mesh.instanceMatrix.needsUpdate = true;
      mesh.behind.count = mesh.count;
    }
  }

  placeLoads(row) {
    const T = this.THREE;
    this.arrows.forEach(({ arrow, whole, dashed, head }, k) => {
      const f = this.parts.force[0] + 3 * k, p = this.parts.pressure[0] + 3 * k;
      const estimated = row[this.parts.source[0] + k] > 1.5; // mbkf.io.contacts.Source: 1 measured, 2 shared, 3 estimated
      const force = new T.Vector3(row[f], row[f + 1], row[f + 2]), length = force.length() / this.newtonPerMetre;
      arrow.visible = this.shown[estimated ? "estimated" : "reactions"] && length > 0.02 && !Number.isNaN(row[p]);
      if (!arrow.visible) return;
      arrow.position.set(row[p], row[p + 1], row[p + 2]);
      arrow.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), force.normalize());
      const tip = Math.min(0.09, 0.5 * length);
      [whole.visible, dashed.visible] = [!estimated, estimated];
      for (const shaft of [whole, dashed]) shaft.scale.set(1, length - tip, 1);
      head.position.y = length - tip;
      head.scale.setScalar(tip / 0.09);
    });
  }
}
