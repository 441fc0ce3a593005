// The numbers at this pose.
"use strict";
SK.makeReadouts = (scene, state) => {
  const { element, section, more } = SK.widgets, { number, percent, quantities, principal } = SK.words;
  const verdict = element("p", { class: "verdict", role: "status" });
  const table = element("table", { class: "numbers first-bold" });
  const facts = element("dl", { class: "facts" }), further = element("dl", { class: "facts" });
  const data = element("div", { class: "data" });
  const root = section("At this pose", verdict, data, facts), rest = section("Stiffness here", table, more("What the load does to it", further));
  const sub = (text) => element("sub", {}, text), K_C = () => element("span", {}, "K", sub("C"));
  const ranks = ["softest", "middle", "stiffest"];

  function principalTable(frame) {
    const quantity = quantities[state.quantity], axes = frame[quantity.group];
    const enhanced = principal(quantity, axes.enhanced), conventional = principal(quantity, axes.conventional);
    const cell = (value) => (value < 0
      ? element("td", { class: "bad" }, number(value * quantity.factor, 4) + " unstable")
      : element("td", {}, value === Infinity ? "rigid" : number(value * quantity.factor, 4)));
    table.replaceChildren(
      element("caption", {}, `${quantity.title} along its principal axes, ${quantity.unit}`),
      element("thead", {}, element("tr", {},
        ...["", element("span", {}, "with ", K_C()), "without", "change"].map((text, k) => element("th", { scope: "col", class: k ? "" : "first" }, text)))),
      element("tbody", {}, ...ranks.map((rank, k) => {
        const change = enhanced[k] / conventional[k] - 1;
        return element("tr", {}, element("th", { scope: "row" }, rank), cell(enhanced[k]), cell(conventional[k]),
          element("td", {}, Number.isFinite(change) ? (change > 0 && Math.abs(change) >= 1e-5 ? "+" : "") + percent(change) : "\u2013"));
      })));
  }

  const vector = (d) => `(${d.map((value) => number(Math.abs(value) < 1e-9 * size(d) ? 0 : 1e6 * value, 3)).join(", ")})`;
  const size = (d) => SK.algebra.norm(d);
  const fact = (name, value, note = "") => [element("dt", {}, name), element("dd", {}, value, note ? element("small", {}, note) : null)];

  // A reading has more in it than the arm: what instruments add, and loads that were on before.
  function asRead(rest, current) {
    const predicted = current && !scene.positions && state.model === scene.models[scene.models.length - 1] && current.predicted[state.model];
    if (!predicted || size(SK.algebra.minus(predicted, rest)) < 1e-3 * size(predicted)) return "";
    return `; as read ${number(1e6 * size(predicted), 4)} µm, with what instruments and earlier loads add`;
  }

  function loadFacts(frame, current) {
    const loaded = size(state.wrench) > 0, rest = frame.deflection.equilibrium;
    const rows = [];
    facts.replaceChildren();
    if (loaded) {
      facts.append(...(rest
        ? fact("Deflection", `${number(1e6 * size(rest), 4)} µm`, `${current && current.said ? `${current.said}: ` : ""}${vector(rest)} µm${asRead(rest, current)}`)
        : fact("Deflection", "none", "no equilibrium: the load is beyond the critical one")));
      const off = (name) => (rest && frame.deflection[name] ? `${number(1e6 * size(SK.algebra.minus(frame.deflection[name], rest)), 2)} µm off` : "\u2013");
      rows.push(...fact(element("span", {}, "One step, with ", K_C()), off("enhanced")), ...fact("One step, without", off("conventional")));
    }
    rows.push(...fact(K_C(), frame.classes.K_C === "zero" ? "zero, no load" : frame.classes.K_C));
    if (frame.softening === null)
      rows.push(...fact("Springs", "indefinite here", "the arm is unstable before any load"));
    else if (loaded) {
      rows.push(...fact(element("span", {}, "Share of ", K_C()), `softens \u2264 ${percent(frame.softening)}`, `stiffens \u2264 ${percent(frame.stiffening)}`));
      const critical = frame.softening > 0 ? 1 / frame.softening : Infinity;
      rows.push(...fact("Critical load", critical === Infinity ? "none this way" : `${number(critical, 3)} \u00d7 this load`));
    }
    further.replaceChildren(...rows);
  }

  function reading(current) {
    const models = current ? Object.entries(current.predicted) : [];
    if (!models.length && !(current && current.measured)) { data.replaceChildren(); return; }
    const row = (name, d, mark) => element("tr", {},
      element("th", { scope: "row" }, element("i", { class: "dot " + mark }), name),
      ...(d ? [...d, size(d)].map((value) => element("td", {}, number(Math.abs(value) < 1e-12 ? 0 : 1e6 * value, 3))) : [element("td", { colspan: 4 }, "\u2013")]));
    const rows = [], other = (name, mark) => (name === state.model ? mark : "other");
    const gap = (name, said) => rows.push(row(said, SK.algebra.minus(current.measured, current.predicted[name]), other(name, "gap")));
    if (scene.positions) {
      // Where the last model has the point is no displacement: only what it is off by is told.
      if (current.measured) models.forEach(([name]) => gap(name, models.length > 1 ? `gap, ${name}` : "gap"));
    } else {
      if (current.measured || scene.listed === "data") rows.push(row("measured", current.measured, "measured"));
      for (const [name, predicted] of models) {
        rows.push(row(name, predicted, other(name, "predicted")));
        if (current.measured) gap(name, "gap");
      }
    }
    if (!rows.length) { data.replaceChildren(); return; }
    const caption = scene.positions ? `Position at ${current.label}, as read less what the model says` : `Displacement at ${current.label}`;
    data.replaceChildren(element("table", { class: "numbers" },
      element("caption", {}, `${caption}, µm`),
      element("thead", {}, element("tr", {}, ...["", "x", "y", "z", "size"].map((text, k) => element("th", { scope: "col", class: k ? "" : "first" }, text)))),
      element("tbody", {}, ...rows)));
  }

  function refresh(frame, current) {
    const stable = frame.classes.stiffness === "positive definite";
    const text = `${stable ? "Stable" : "Not stable"}: K\u03b8 \u2212 KC is ${frame.classes.stiffness}`;
    if (verdict.textContent !== text)
      verdict.replaceChildren(text.split(":")[0] + ": K", sub("\u03b8"), " \u2212 K", sub("C"), ` is ${frame.classes.stiffness}`);
    verdict.classList.toggle("bad", !stable);
    principalTable(frame);
    loadFacts(frame, current);
    reading(current);
  }
  return { root, rest, refresh };
};
