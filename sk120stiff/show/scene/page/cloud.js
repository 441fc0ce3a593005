// A map: coloured points around the robot, a scale, and sliders that hide what is not asked for.
"use strict";
SK.startCloud = (scene) => {
  const THREE = MeshCat.THREE, { cloud } = scene, { element, slider, button } = SK.widgets;
  const pane = document.getElementById("pane"), panel = document.getElementById("panel");
  const stage = SK.makeStage(pane, scene), camera = SK.makeCamera(stage);

  function numbers(text) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  }
  const position = numbers(cloud.position), values = numbers(cloud.values);
  const [low, high] = cloud.colour_range;
  const linear = cloud.colours.map((rgb) => new THREE.Color(...rgb).convertSRGBToLinear());
  const colour = new Float32Array(position.length);
  values.forEach((value, k) => {
    const share = Math.min(1, Math.max(0, (value - low) / (high - low)));
    linear[Math.round(share * (linear.length - 1))].toArray(colour, 3 * k);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colour, 3));
  const size = { dot: 0.5 };
  // Neighbouring points are about this far apart if they fill their box.
  geometry.computeBoundingBox();
  const extent = geometry.boundingBox.getSize(new THREE.Vector3());
  const filled = [extent.x, extent.y, extent.z].filter((each) => each > 1e-9);
  const spacing = filled.length ? (filled.reduce((a, b) => a * b, 1) / values.length) ** (1 / filled.length) : 0.05 * stage.reach;
  const material = new THREE.PointsMaterial({ size: size.dot * spacing, vertexColors: true, sizeAttenuation: true });
  const points = new THREE.Points(geometry, material);
  stage.viewer.set_object(["map", "points"], points);

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
  const places = Math.max(0, 3 - Math.floor(Math.log10(span)));
  const reading = (key, label) => slider({
    label, unit: cloud.unit || "1", factor: 1, lower: cloud.range[0], upper: cloud.range[1], step: "any", places,
    read: () => limits[key], write: (value) => { limits[key] = value; choose(); },
  }).row;
  const stops = cloud.colours.filter((_, k) => k % 15 === 0)
    .map((rgb) => `rgb(${rgb.map((part) => Math.round(255 * part)).join(" ")})`).join(", ");
  const shown = (value) => Number(value.toPrecision(4)).toString();
  panel.append(
    element("section", {},
      element("h2", {}, cloud.label + (cloud.unit ? ` [${cloud.unit}]` : "")),
      element("div", { class: "scale", style: `background: linear-gradient(90deg, ${stops})` }),
      element("div", { class: "ends" }, element("span", {}, `≤ ${shown(low)}`), element("span", {}, `≥ ${shown(high)}`)),
      count),
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
  camera.preset("overview", null, false);
};
