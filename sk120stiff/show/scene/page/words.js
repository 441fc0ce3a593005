// Numbers and units as engineers read them, and lines to copy.
"use strict";
SK.words = (() => {
  const minus = (text) => text.replace("-", "\u2212");

  function number(value, digits = 3) {
    if (value === null || value === undefined || Number.isNaN(value)) return "\u2013";
    if (!Number.isFinite(value)) return value > 0 ? "\u221e" : "\u2212\u221e";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e6 || size < 1e-4) {
      const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
      const raised = String(Number(exponent)).replace(/[-0-9]/g, (c) => "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"["-0123456789".indexOf(c)]);
      return minus(`${mantissa}\u00b710${raised}`);
    }
    const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
    return minus(value.toFixed(Math.min(places, 6)));
  }

  const percent = (share) => {
    const value = 100 * share;
    return (value === 0 ? "0" : Math.abs(value) < 1e-3 ? "< 0.001" : number(value, 2)) + "\u00a0%";
  };

  // What an ellipsoid can show. `inverse`: one over the compliance.
  const quantities = {
    compliance: { title: "Compliance", group: "translation", reference: ["translation", "compliance"], unit: "\u00b5m/N", factor: 1e6, inverse: false, drawn: "displacement for a force of 1 N" },
    stiffness: { title: "Stiffness", group: "translation", reference: ["translation", "stiffness"], unit: "N/\u00b5m", factor: 1e-6, inverse: true, drawn: "force for a displacement of 1 m" },
    turnCompliance: { title: "Rotational compliance", group: "rotationAxes", reference: ["rotation", "compliance"], unit: "\u00b5rad/(N\u00b7m)", factor: 1e6, inverse: false, drawn: "rotation for a moment of 1 N\u00b7m" },
    turnStiffness: { title: "Rotational stiffness", group: "rotationAxes", reference: ["rotation", "stiffness"], unit: "kN\u00b7m/rad", factor: 1e-3, inverse: true, drawn: "moment for a rotation of 1 rad" },
  };

  // Principal values in SI: stiffness is infinite where the compliance vanishes.
  function principal(quantity, axes) {
    if (!quantity.inverse) return axes.values;
    const largest = Math.max(...axes.values.map(Math.abs));
    return axes.values.map((c) => (Math.abs(c) <= 1e-12 * largest ? Infinity : 1 / c));
  }

  const degrees = (value) => (value * 180) / Math.PI;
  const plain = (value, places) => String(Number(value.toFixed(places)));

  function command(scene, state) {
    const slides = scene.joints.some((joint) => joint.slides);
    const pose = slides
      ? scene.joints.map((joint, k) => `${joint.name}=${joint.slides ? plain(1e3 * state.a[k], 4) + " mm" : plain(degrees(state.a[k]), 5) + " deg"}`).join(", ")
      : state.a.map((value) => plain(degrees(value), 5)).join(",") + " deg";
    const moments = state.wrench.slice(3).some((value) => value !== 0);
    const wrench = moments
      ? state.wrench.map((value) => plain(value, 4)).join(",") + " N, N*m"
      : state.wrench.slice(0, 3).map((value) => plain(value, 4)).join(",") + " N";
    const model = scene.command.model ? ` --model ${quoted(scene.command.model)}` : "";
    return `sk120stiff stiffness ${quoted(scene.command.robot)} --pose '${pose}' --wrench '${wrench}'${model}`;
  }

  const quoted = (text) => (/^[\w./@%+=:,-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

  function python(scene, state) {
    const list = (values, places) => "[" + values.map((value) => plain(value, places)).join(", ") + "]";
    return [
      "import numpy as np",
      "from sk120stiff import load_robot",
      "",
      `robot = load_robot(${JSON.stringify(scene.command.robot)})`,
      `a = np.array(${list(state.a, 9)})  # ${scene.joints.map((joint) => joint.name).join(", ")} [rad or m]`,
      `wrench = np.array(${list(state.wrench, 6)})  # force [N], moment [N·m], axes of ${scene.base}`,
      `point = np.array(${list(state.point, 9)})  # in ${scene.frame} [m]`,
      `screws = robot.screws(a, frame=${JSON.stringify(scene.frame)}, point=point)`,
      "print(screws.position, screws.jacobian, sep=\"\\n\")",
    ].join("\n");
  }

  return { number, percent, quantities, principal, degrees, command, python };
})();
