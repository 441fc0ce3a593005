// Puts the page together: state, physics, picture, panel.
"use strict";
SK.start = (scene) => {
  const m = SK.algebra, { quantities, principal, number } = SK.words;
  const pane = document.getElementById("pane");
  const stage = SK.makeStage(pane, scene), camera = SK.makeCamera(stage), actors = SK.makeActors(stage, scene);
  const { colours } = SK, { scale, poses } = scene, { reach } = scale;
  const state = {
    a: scene.start.a.slice(), wrench: scene.start.wrench.slice(), point: scene.start.point.slice(),
    exaggeration: scale.exaggeration, scale: 1, quantity: "compliance", formulation: "enhanced",
    pose: -1, reading: -1, model: scene.models[scene.models.length - 1] || "",
    show: { ellipsoid: !scene.marks.length && !scene.path, labels: true, deflected: !scene.path, load: true, displacements: true, frames: false },
  };
  const same = (a, b) => a.every((value, k) => Math.abs(value - b[k]) < 1e-12);
  state.pose = poses.findIndex((pose) => same(pose.a, state.a));
  if (state.pose >= 0) state.reading = poses[state.pose].readings.findIndex((reading) => same(reading.wrench, state.wrench) && same(reading.point, state.point));

  const ellipsoids = {
    enhanced: actors.makeEllipsoid("enhanced", colours.enhanced, true),
    conventional: actors.makeEllipsoid("conventional", colours["conventional-line"], false),
    conventionalFilled: actors.makeEllipsoid("conventional_filled", colours["conventional-line"], true),
  };
  const arrows = {
    force: actors.makeArrow("force", colours.ink),
    moment: actors.makeArrow("moment", colours.ink, { doubled: true }),
    measured: actors.makeArrow("measured", colours.measured),
    predicted: actors.makeArrow("predicted", colours.predicted),
    gap: actors.makeArrow("gap", colours.gap),
    before: actors.makeArrow("before", colours.before),
  };
  const marks = scene.marks.map(([link, text]) => ({ link, text, words: actors.makeLabel("named") }));
  const path = scene.path && SK.makePath(stage, actors, scene.path);
  const frames = { base: actors.makeFrame("base", 0.16 * reach), tool: actors.makeFrame("tool", 0.1 * reach) };
  let frame = null, pending = false, asked = 0, flight = 0, gliding = false, timer = 0;

  const onState = (kind, text) => {
    const banner = document.getElementById("connection");
    banner.hidden = kind === "open";
    banner.textContent = kind === "closed" ? "The connection to the program is lost; trying again." : kind === "refused" ? `The program refused this: ${text}` : "";
  };
  const engine = scene.mode === "live"
    ? SK.makeSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`, onState)
    : SK.makeEngine(scene.kinematics, onState);

  function changed() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      asked = performance.now();
      engine.request(state, (answer) => { asked = 0; frame = answer; redraw(); });
    });
  }

  const currentReading = () => (state.pose >= 0 && state.reading >= 0 ? poses[state.pose].readings[state.reading] : null);

  function drawEllipsoids() {
    Object.values(ellipsoids).forEach((ellipsoid) => ellipsoid.hide());
    if (!state.show.ellipsoid) return;
    const quantity = quantities[state.quantity], [group, kind] = quantity.reference;
    const perUnit = (0.13 * reach * state.scale) / scale.references[group][kind];
    const limit = 0.45 * reach * state.scale;
    const draw = (ellipsoid, name, texts) => {
      const axes = frame[quantity.group][name], values = principal(quantity, axes);
      // A negative value has no ellipsoid: it is an unstable direction, and only its axis is drawn.
      const lengths = values.map((value) => (value < 0 ? limit : Math.min(value * perUnit, limit)));
      const capped = values.map((value) => value < 0 || value * perUnit > limit);
      ellipsoid.set(frame.position, axes.directions, lengths, {
        whole: values.every((value) => value >= 0 && value !== Infinity), capped,
        texts: values.map((value) => (!state.show.labels || !texts ? "" : value < 0 ? "unstable" : value === Infinity || Math.abs(value) <= 1e-9 * Math.abs(values[0]) ? "rigid" : `${number(value * quantity.factor)} ${quantity.unit}`)),
      });
    };
    if (state.formulation === "conventional") draw(ellipsoids.conventionalFilled, "conventional", true);
    else draw(ellipsoids.enhanced, "enhanced", true);
    if (state.formulation === "both") draw(ellipsoids.conventional, "conventional", false);
  }

  function drawArrows() {
    Object.values(arrows).forEach((arrow) => arrow.hide());
    const from = frame.position, force = state.wrench.slice(0, 3), moment = state.wrench.slice(3);
    if (state.show.load) {
      const longest = 0.22 * reach;
      if (m.norm(force) > 0) arrows.force.set(from, m.scaled(force, longest / scene.limits.force), `${number(m.norm(force))} N`);
      if (m.norm(moment) > 0) arrows.moment.set(from, m.scaled(moment, longest / scene.limits.moment), `${number(m.norm(moment))} N·m`);
    }
    const reading = currentReading(), factor = state.exaggeration;
    if (reading && state.show.displacements) {
      const predicted = reading.predicted[state.model], moved = !scene.positions; // else only the gap is a way
      if (moved && reading.measured) arrows.measured.set(from, m.scaled(reading.measured, factor));
      if (moved && predicted) arrows.predicted.set(from, m.scaled(predicted, factor));
      const first = reading.predicted[scene.models[0]];
      const gap = (arrow, model, name) => {
        const vector = m.minus(reading.measured, model);
        arrow.set(from, m.scaled(vector, scale.gap), `${name} ${number(1e6 * m.norm(vector))} µm`);
      };
      if (first && reading.measured && state.model !== scene.models[0]) gap(arrows.before, first, `gap ${scene.models[0]}`);
      if (predicted && reading.measured) gap(arrows.gap, predicted, "gap");
    }
  }

  const baseAxes = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  function redraw() {
    if (!frame) return;
    for (const group of ["robot", "around"]) stage.placeLinks(group, frame.links);
    const bent = state.show.deflected && frame.deflected && m.norm(state.wrench) > 0;
    stage.show(["deflected"], Boolean(bent));
    if (bent) stage.placeTwin(frame.deflected, frame.links);
    drawEllipsoids();
    drawArrows();
    marks.forEach(({ link, text, words }) => words.set(frame.links[link].slice(12, 15), state.show.labels ? text : ""));
    if (path) path.follow(frame);
    frames.base.set([0, 0, 0], baseAxes, state.show.frames);
    frames.tool.set(frame.position, frame.rotation, state.show.frames);
    readouts.refresh(frame, currentReading());
    legend();
    stage.viewer.set_dirty();
    SK.drawn = (SK.drawn || 0) + 1;
  }

  function legend() {
    const quantity = quantities[state.quantity], [group, kind] = quantity.reference;
    const perMetre = scale.references[group][kind] / (0.13 * state.scale); // of the arm's reach
    const { element } = SK.widgets, K_C = element("sub", {}, "C");
    const entry = (mark, ...text) => element("li", {}, element("i", { class: "dot " + mark }), element("span", {}, ...text));
    const rows = [];
    if (state.show.ellipsoid) {
      const text = `${quantity.title.toLowerCase()}, half axis of ${number(0.1 * reach, 2)} m = ${number(0.1 * perMetre * quantity.factor)} ${quantity.unit}`;
      if (state.formulation !== "conventional") rows.push(entry("enhanced", `${text}, with K`, K_C));
      if (state.formulation !== "enhanced") rows.push(entry("conventional", state.formulation === "both" ? "the same without K" : `${text}, without K`, K_C.cloneNode(true)));
    }
    const times = `\u00d7 ${Number(state.exaggeration.toPrecision(3))}`;
    if (state.show.deflected && m.norm(state.wrench) > 0) rows.push(entry("deflected", frame.deflected ? `deflected shape, ${times}` : "no equilibrium: beyond the critical load"));
    const reading = currentReading(), predicted = `predicted, ${state.model}`;
    if (reading && !reading.measured && state.model && !scene.positions && state.show.displacements) rows.push(entry("predicted", `${predicted}, ${times}`));
    if (reading && reading.measured && state.show.displacements)
      rows.push(...(scene.positions ? [] : [entry("measured", `measured, ${times}`), ...(state.model ? [entry("predicted", predicted)] : [])]),
        ...(state.model ? [entry("gap", `gap${scene.positions ? " of position" : ""}, \u00d7 ${Number(scale.gap.toPrecision(3))}`)] : []),
        ...(scene.models.length > 1 && state.model !== scene.models[0] ? [entry("before", `gap ${scene.models[0]}, the same scale`)] : []));
    if (scene.marks.length) rows.push(entry("named", "where what was named acts"));
    if (path) rows.push(...path.legend.map((row) => entry(...row)));
    document.getElementById("legend").replaceChildren(...rows);
  }

  // Move smoothly to a pose; the numbers follow all the way.
  function glide(target) {
    const mine = ++flight, from = state.a.slice(), begin = performance.now();
    const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    const step = () => {
      if (mine !== flight) return;
      const t = still ? 1 : Math.min(1, (performance.now() - begin) / 600), ease = t * t * (3 - 2 * t);
      state.a = t === 1 ? target.slice() : from.map((value, k) => value + ease * (target[k] - value));
      panel.refresh();
      changed();
      if (t < 1) requestAnimationFrame(step);
      else setTimeout(arrive, 60);
    };
    // The camera follows the picture of the target, which a slow machine owes for a while.
    const arrive = () => {
      if (mine !== flight) return;
      if (pending || asked) { setTimeout(arrive, 30); return; }
      gliding = false;
      camera.follow(frame.position);
    };
    gliding = true;
    step();
  }
  const stop = () => { clearTimeout(timer); timer = 0; panel.playing(false); };

  const takeUp = ({ wrench, point }) => Object.assign(state, { wrench: wrench.slice(), point: point.slice() });

  const actions = {
    changed, redraw,
    leavePose() { flight++; gliding = false; stop(); state.pose = -1; state.reading = -1; panel.refresh(); changed(); },
    leaveReading() { state.reading = -1; panel.refresh(); changed(); },
    goToPose(k) {
      state.pose = k;
      const { readings } = poses[k];
      const usual = scene.positions ? 0 : readings.length - 1;
      state.reading = readings.length ? Math.min(state.reading < 0 ? usual : state.reading, readings.length - 1) : -1;
      state.point = scene.start.point.slice();
      if (state.reading >= 0) takeUp(readings[state.reading]);
      glide(poses[k].a);
    },
    goToReading(k) {
      if (k < 0) { actions.leaveReading(); return; }
      state.reading = k;
      takeUp(poses[state.pose].readings[k]);
      panel.refresh();
      changed();
    },
    step(by) { stop(); actions.goToPose((Math.max(0, state.pose) + by + poses.length) % poses.length); },
    home() {
      stop();
      state.pose = -1; state.reading = -1;
      state.point = scene.start.point.slice();
      glide(scene.joints.map(({ lower, upper }) => Math.min(upper, Math.max(lower, 0))));
    },
    unload() { state.wrench = [0, 0, 0, 0, 0, 0]; actions.leaveReading(); },
    play() {
      if (timer) { stop(); return; }
      panel.playing(true);
      const next = () => { actions.goToPose((state.pose + 1) % poses.length); timer = setTimeout(next, 2400); };
      timer = setTimeout(next, 0);
    },
    screenshot() {
      const link = document.createElement("a");
      link.href = camera.picture();
      link.download = `${scene.robot}.png`;
      link.click();
    },
  };

  const readouts = SK.makeReadouts(scene, state);
  document.getElementById("panel").append(readouts.root);
  const panel = SK.makePanel(scene, state, actions);
  // With poses to visit the controls come first, and stiffness stands behind them.
  if (poses.length) panel.root.lastChild.before(readouts.rest);
  else readouts.root.after(readouts.rest);
  const legendList = document.getElementById("legend"), narrow = window.matchMedia("(max-width: 900px)");
  const settle = () => (narrow.matches ? panel.root.prepend(legendList) : pane.after(legendList));
  narrow.addEventListener("change", settle);
  settle();
  const chips = document.getElementById("views");
  camera.names.forEach((name) => chips.append(SK.widgets.button(name, () => camera.preset(name, frame && frame.position), { "aria-label": `Camera: ${name}` })));

  let first = true;
  const begin = (answer) => {
    frame = answer;
    redraw();
    if (!first) return;
    first = false;
    stage.layFloor();
    camera.preset("overview", frame.position, false);
    document.documentElement.dataset.ready = "yes";
  };
  engine.request(state, begin);
  // Is anything still to be computed, moved or drawn?
  const busy = () => Boolean(pending || asked || gliding || camera.busy() || stage.viewer.needs_render);
  Object.assign(SK, { busy, state, stage, camera, actions, changed, redraw, panel, frame: () => frame, picture: camera.picture, still: camera.still });
};
