// A map: coloured points around the robot, the softest one named, values under the pointer.
"use strict";
SK.startCloud = (scene) => {
  const THREE = MeshCat.THREE, { cloud } = scene, { element, slider, button } = SK.widgets, { number } = SK.words;
  const pane = document.getElementById("pane"), panel = document.getElementById("panel");
  const stage = SK.makeStage(pane, scene), camera = SK.makeCamera(stage), actors = SK.makeActors(stage, scene);

  function numbers(text) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  }
  const position = numbers(cloud.position), values = numbers(cloud.values), places = numbers(cloud.places);
  const [low, high] = cloud.colour_range, { axes } = cloud;
  const linear = cloud.colours.map((rgb) => new THREE.Color(...rgb).convertSRGBToLinear());
  const colour = new Float32Array(position.length);
  values.forEach((value, k) => {
    const share = Math.min(1, Math.max(0, (value - low) / (high - low)));
    linear[Math.round(share * (linear.length - 1))].toArray(colour, 3 * k);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colour, 3));
  const size = { dot: 0.6 };
  // Neighbouring points are about this far apart if they fill their box.
  geometry.computeBoundingBox();
  const extent = geometry.boundingBox.getSize(new THREE.Vector3());
  const filled = [extent.x, extent.y, extent.z].filter((each) => each > 1e-9);
  const spacing = filled.length ? (filled.reduce((a, b) => a * b, 1) / values.length) ** (1 / filled.length) : 0.05 * stage.reach;
  // A disk with a darker rim: it is seen on every background, and before others of its colour.
  const disk = document.createElement("canvas"), brush = disk.getContext("2d");
  disk.width = disk.height = 64;
  for (const [radius, shade] of [[31, "#8d8d8d"], [24, "#ffffff"]]) {
    brush.fillStyle = shade;
    brush.beginPath();
    brush.arc(32, 32, radius, 0, 2 * Math.PI);
    brush.fill();
  }
  const material = new THREE.PointsMaterial({
    size: size.dot * spacing, vertexColors: true, sizeAttenuation: true, map: new THREE.CanvasTexture(disk), alphaTest: 0.5, fog: false,
  });
  const points = new THREE.Points(geometry, material);
  stage.viewer.set_object(["map", "points"], points);

  const at = (k) => [...position.subarray(3 * k, 3 * k + 3)];
  const valued = (k) => `${number(values[k], 4)}${cloud.unit ? " " + cloud.unit : ""}`;
  const where = (k) => axes.map(({ name, unit }, i) => `${name} ${number(places[axes.length * k + i], 4)}${unit === "°" ? "" : " "}${unit}`).join(", ");

  // The softest point and the stiffest: named on the map, and in words.
  const marks = cloud.marks.map(({ point, text }, i) => {
    const ring = new THREE.Mesh(new THREE.SphereGeometry(0.022 * stage.reach, 24, 16), stage.materials.flat(SK.colours[i ? "soft-ink" : "ink"]));
    ring.renderOrder = 5;
    stage.put(["map", "mark" + i], ring);
    stage.move(["map", "mark" + i], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...at(point), 1]);
    actors.makeLabel("mark").set(at(point), `${text} ${valued(point)}`);
    return element("p", { class: "mark" }, element("strong", {}, `${text}: ${valued(point)}`), ` at ${where(point)}`);
  });

  // The point under the pointer, or under the finger.
  const hint = actors.makeLabel("hint"), caster = new THREE.Raycaster(), pointer = new THREE.Vector2();
  const told = element("p", { id: "told", role: "status" }, "Point at the map to read it.");
  function tell(event) {
    const box = pane.getBoundingClientRect();
    pointer.set(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    caster.setFromCamera(pointer, stage.viewer.camera);
    caster.params.Points.threshold = 0.5 * size.dot * spacing;
    const hit = caster.intersectObject(points).sort((a, b) => a.distance - b.distance)[0];
    if (hit) {
      hint.set(at(hit.index), valued(hit.index));
      told.textContent = `${valued(hit.index)} at ${where(hit.index)}`;
    } else hint.hide();
    stage.viewer.set_dirty();
  }
  pane.addEventListener("pointermove", tell);
  pane.addEventListener("pointerdown", tell);

  // What is drawn: values between the limits, beyond the cut: the camera begins on the side of negative y.
  const limits = { from: cloud.range[0], to: cloud.range[1] };
  const box = geometry.boundingBox, cut = { y: box.min.y };
  const count = element("p", { id: "count", role: "status" });
  function choose() {
    const kept = [];
    values.forEach((value, k) => {
      if (value >= limits.from && value <= limits.to && position[3 * k + 1] >= cut.y) kept.push(k);
    });
    geometry.setIndex(kept);
    count.textContent = `${kept.length.toLocaleString("en")} of ${values.length.toLocaleString("en")} points`;
    stage.viewer.set_dirty();
  }

  const span = (cloud.range[1] - cloud.range[0]) || 1;
  const digits = Math.max(0, 3 - Math.floor(Math.log10(span)));
  const reading = (key, label) => slider({
    label, unit: cloud.unit || "1", factor: 1, lower: cloud.range[0], upper: cloud.range[1], step: "any", places: digits,
    read: () => limits[key], write: (value) => { limits[key] = value; choose(); },
  }).row;
  const stops = cloud.colours.filter((_, k) => k % 15 === 0)
    .map((rgb) => `rgb(${rgb.map((part) => Math.round(255 * part)).join(" ")})`).join(", ");
  panel.append(
    element("section", {},
      element("h2", {}, cloud.label + (cloud.unit ? ` [${cloud.unit}]` : "")),
      ...marks,
      element("div", { class: "scale", style: `background: linear-gradient(90deg, ${stops})` }),
      element("div", { class: "ends" },
        element("span", {}, `${cloud.ends[0]} \u2264 ${number(low, 4)}`), element("span", {}, `\u2265 ${number(high, 4)} ${cloud.ends[1]}`)),
      told, count),
    element("section", {},
      element("h2", {}, "Show"),
      reading("from", "at least"),
      reading("to", "at most"),
      slider({
        label: "cut away below y", unit: "mm", factor: 1000, lower: box.min.y, upper: box.max.y || box.min.y + 1e-9, step: "any", places: 0,
        read: () => cut.y, write: (value) => { cut.y = value; choose(); },
      }).row,
      slider({
        label: "size of the points", unit: "%", factor: 100, lower: 0.05, upper: 1.5, step: "any", places: 0,
        read: () => size.dot, write: (value) => { size.dot = value; material.size = value * spacing; stage.viewer.set_dirty(); },
      }).row));

  stage.placeLinks("robot", scene.links_at);
  stage.show(["deflected"], false);
  stage.layFloor();
  const robotBounds = stage.bounds;
  stage.bounds = () => robotBounds().union(new THREE.Box3().setFromObject(points));
  const views = document.getElementById("views");
  for (const name of camera.names.filter((each) => each !== "tool")) {
    views.append(button(name, () => camera.preset(name, null), { "aria-label": `Camera: ${name}` }));
  }
  choose();
  SK.drawn = 1;
  camera.preset("overview", null, false);
  document.documentElement.dataset.ready = "yes";
  const busy = () => Boolean(camera.busy() || stage.viewer.needs_render);
  Object.assign(SK, { busy, stage, camera, still: camera.still, screenOf: (k) => actors.screenOf(at(k)) });
};
