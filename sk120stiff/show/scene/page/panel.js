// The controls beside the picture.
"use strict";
SK.makePanel = (scene, state, actions) => {
  const { element, slider, choice, select, toggle, button, section, more } = SK.widgets;
  const controls = [];
  const keep = (control) => { controls.push(control); return control.row; };
  const { joints, poses, limits } = scene;

  const jointSliders = joints.map((joint, k) => keep(slider({
    label: joint.name, unit: joint.slides ? "mm" : "\u00b0", factor: joint.slides ? 1e3 : 180 / Math.PI,
    lower: joint.lower, upper: joint.upper, step: joint.slides ? 0.5 : 0.1, places: 3,
    read: () => state.a[k], write: (value) => { state.a[k] = value; actions.leavePose(); },
  })));

  const poseList = poses.length ? [
    element("div", { class: "row" },
      keep(select({
        label: `Pose of the ${scene.listed}`,
        options: [["-1", "free"], ...poses.map((pose, k) => [String(k), pose.label])],
        read: () => state.pose, write: (value) => { if (Number(value) >= 0) actions.goToPose(Number(value)); },
      })),
      element("div", { class: "buttons" },
        button("\u2039", () => actions.step(-1), { "aria-label": "Previous pose", class: "icon" }),
        button("\u203a", () => actions.step(1), { "aria-label": "Next pose", class: "icon" }))),
  ] : [];
  const play = button("Play", () => actions.play(), { "aria-pressed": "false" });
  const poseButtons = element("div", { class: "buttons" },
    button("Home", () => actions.home()), ...(poses.length > 1 ? [play] : []));

  const readings = select({
    label: "Reading", options: [], read: () => state.reading,
    write: (value) => actions.goToReading(Number(value)),
  });
  controls.push(readings);
  function refreshReadings() {
    const known = state.pose >= 0 ? poses[state.pose].readings : [];
    const words = ({ said, wrench }) => said ?? `${SK.words.number(SK.algebra.norm(wrench.slice(0, 3)), 3)} N`;
    readings.row.hidden = !known.length || (known.length === 1 && words(known[0]) === "");
    readings.menu.replaceChildren(element("option", { value: "-1" }, "free"),
      ...known.map((reading, k) => element("option", { value: String(k) }, [reading.label, words(reading)].filter(Boolean).join(": "))));
  }

  const largest = (k) => (k < 3 ? limits.force : limits.moment);
  const loadSlider = (k) => keep(slider({
    label: ["Force x", "Force y", "Force z", "Moment x", "Moment y", "Moment z"][k], unit: k < 3 ? "N" : "N\u00b7m", factor: 1,
    lower: -largest(k), upper: largest(k), step: largest(k) / 500, places: 2,
    read: () => state.wrench[k], write: (value) => { state.wrench[k] = value; actions.leaveReading(); },
  }));
  const pointSlider = (k) => keep(slider({
    label: `Point ${"xyz"[k]}`, unit: "mm", factor: 1e3, lower: -limits.point, upper: limits.point, step: 1, places: 2,
    read: () => state.point[k], write: (value) => { state.point[k] = value; actions.leavePose(); },
  }));

  const sizes = element("div", {}, exponential("Size of the ellipsoid", "scale", 0.2, 5), exponential("Exaggeration", "exaggeration", ...limits.exaggeration));
  // A slider over powers of ten whose field shows the factor itself.
  function exponential(label, key, lower, upper) {
    const made = slider({
      label, unit: "\u00d7", factor: 1, lower: Math.log10(lower), upper: Math.log10(upper), step: 0.01, places: 2,
      read: () => Math.log10(state[key]), write: (value) => { state[key] = 10 ** value; actions.changed(); },
    });
    const field = made.row.querySelector("input[type=number]"), range = made.row.querySelector("input[type=range]");
    const fresh = field.cloneNode();
    Object.assign(fresh, { min: lower, max: upper });
    field.replaceWith(fresh);
    const write = () => { fresh.value = String(Number(state[key].toPrecision(3))); range.setAttribute("aria-valuetext", `${fresh.value} times`); };
    range.addEventListener("input", write);
    fresh.addEventListener("change", () => {
      const value = Number(fresh.value);
      if (value > 0) state[key] = Math.min(upper, Math.max(lower, value));
      actions.changed();
      refresh();
    });
    const refresh = () => { made.refresh(); write(); };
    controls.push({ refresh });
    write();
    return made.row;
  }

  const names = Object.fromEntries(Object.entries(SK.words.quantities).map(([key, value]) => [key, value.title]));
  const view = [
    keep(choice({ label: "Ellipsoid", options: names, read: () => state.quantity, write: (value) => { state.quantity = value; actions.redraw(); } })),
    keep(choice({ label: "Formulation", options: { enhanced: "with K_C", conventional: "without", both: "both" }, read: () => state.formulation, write: (value) => { state.formulation = value; actions.redraw(); } })),
    sizes,
    element("div", { class: "toggles" },
      ...Object.entries({ ellipsoid: "Ellipsoid", labels: "Values", deflected: "Deflected shape", load: "Load", displacements: "Displacements", frames: "Frames" })
        .map(([key, label]) => keep(toggle({ label, read: () => state.show[key], write: (value) => { state.show[key] = value; actions.redraw(); } })))),
  ];
  if (scene.models.length > 1) {
    view.push(keep(choice({ label: "Predicted by", options: Object.fromEntries(scene.models.map((name) => [name, name])), read: () => state.model, write: (value) => { state.model = value; actions.redraw(); } })));
  }

  const note = element("p", { class: "copied", role: "status" });
  const lines = element("pre", { tabindex: "0", "aria-label": "Command" }, element("code", {}));
  async function copy(text, what) {
    try { await navigator.clipboard.writeText(text); note.textContent = `${what} copied.`; }
    catch { note.textContent = "Copying is blocked here: take it from the lines below."; }
    lines.firstChild.textContent = text;
    lines.hidden = false;
  }
  lines.hidden = true;
  const share = section("Take it along",
    element("div", { class: "buttons" },
      button("Screenshot", () => actions.screenshot()),
      button("Copy as command", () => copy(SK.words.command(scene, state), "Command")),
      button("Copy as Python", () => copy(SK.words.python(scene, state), "Python"))),
    note, lines);

  const root = document.getElementById("panel");
  root.append(
    section("Pose", ...poseList, poseButtons, ...jointSliders),
    section("Load at the point", readings.row, loadSlider(0), loadSlider(1), loadSlider(2),
      element("div", { class: "buttons" }, button("No load", () => actions.unload())),
      more("Moment", loadSlider(3), loadSlider(4), loadSlider(5)),
      more(`Point in ${scene.frame}`, pointSlider(0), pointSlider(1), pointSlider(2))),
    section("Show", ...view),
    share);

  refreshReadings();
  readings.refresh();
  return {
    root,
    refresh() {
      refreshReadings();
      controls.forEach((control) => control.refresh());
    },
    playing(on) { play.setAttribute("aria-pressed", String(on)); play.textContent = on ? "Stop" : "Play"; },
  };
};
