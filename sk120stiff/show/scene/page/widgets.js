// Controls: every one has a label, works from the keyboard and says its unit.
"use strict";
SK.widgets = (() => {
  let serial = 0;

  function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name === "class") made.className = value;
      else if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
      else if (value === true) made.setAttribute(name, "");
      else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
    }
    made.append(...children.filter((child) => child !== null && child !== undefined));
    return made;
  }

  // A slider with a number field beside it. `read` and `write` work in SI, the field in `unit`.
  function slider({ label, unit, factor, lower, upper, step, read, write, places = 2, short = "" }) {
    const id = "c" + ++serial;
    const shown = (value) => String(Number((value * factor).toFixed(places)));
    const range = element("input", {
      type: "range", id, min: lower * factor, max: upper * factor, step, "aria-label": `${label} in ${unit}`,
    });
    const field = element("input", {
      type: "number", min: lower * factor, max: upper * factor, step: "any", inputmode: "decimal", "aria-label": `${label}, value in ${unit}`,
    });
    const clamp = (value) => Math.min(upper, Math.max(lower, value));
    range.addEventListener("input", () => { write(clamp(Number(range.value) / factor)); field.value = shown(read()); paint(); });
    field.addEventListener("change", () => {
      const value = Number(field.value);
      if (field.value !== "" && Number.isFinite(value)) write(clamp(value / factor));
      refresh();
    });
    const paint = () => {
      const share = (Number(range.value) - Number(range.min)) / (Number(range.max) - Number(range.min));
      range.style.setProperty("--fill", `${100 * share}%`);
    };
    function refresh() {
      range.value = read() * factor;
      if (document.activeElement !== field || field.value === "") field.value = shown(read());
      paint();
    }
    refresh();
    const row = element("div", { class: "slider" },
      element("label", { for: id, title: label }, short || label), field, element("span", { class: "unit" }, unit), range);
    return { row, refresh };
  }

  function choice({ label, options, read, write, hidden = false }) {
    const name = "c" + ++serial;
    const inputs = Object.entries(options).map(([value, text]) => {
      const input = element("input", { type: "radio", name, value, onchange: () => write(value) });
      return { value, input, box: element("label", {}, input, element("span", {}, text)) };
    });
    const refresh = () => inputs.forEach(({ value, input }) => { input.checked = value === read(); });
    refresh();
    const row = element("fieldset", { class: "choice" }, element("legend", { class: hidden ? "unseen" : "" }, label),
      element("div", { class: "segments" }, ...inputs.map(({ box }) => box)));
    return { row, refresh };
  }

  function select({ label, options, read, write }) {
    const id = "c" + ++serial;
    const menu = element("select", { id, onchange: () => write(menu.value) },
      ...options.map(([value, text]) => element("option", { value }, text)));
    const refresh = () => { menu.value = String(read()); };
    refresh();
    return { row: element("div", { class: "select" }, element("label", { for: id }, label), menu), refresh, menu };
  }

  function toggle({ label, read, write }) {
    const input = element("input", { type: "checkbox", role: "switch", onchange: () => write(input.checked) });
    const refresh = () => { input.checked = read(); };
    refresh();
    return { row: element("label", { class: "toggle" }, input, element("span", { class: "knob" }), element("span", {}, label)), refresh };
  }

  const button = (text, action, attributes = {}) => element("button", { type: "button", onclick: action, ...attributes }, text);

  const section = (title, ...children) => element("section", {}, element("h2", {}, title), ...children);

  const more = (title, ...children) => element("details", {}, element("summary", {}, title), ...children);

  return { element, slider, choice, select, toggle, button, section, more };
})();
