// The physics of a page without a server: kinematics with the coupling q = A a + b, the Jacobian of
// the point, K_C, compliance, loaded equilibrium. The same formulas as in Python (show/frame.py).
"use strict";
SK.makeEngine = (constants, onState = () => {}) => {
  const m = SK.algebra;
  const { drives, A, b, offset, compliance: C, chain, tree } = constants;
  const n = C.length;
  // Principal compliances of the coordinates that are not zero, and their directions as rows.
  const yielding = (() => {
    const { values, directions } = m.eigen(m.symmetric(C));
    const largest = Math.max(0, ...values.map(Math.abs));
    const kept = values.map((value, k) => k).filter((k) => Math.abs(values[k]) > 1e-12 * largest);
    return { c: kept.map((k) => values[k]), V: kept.map((k) => directions[k]) };
  })();

  const jointValues = (z) => m.add(m.apply(A, z), b); // all joints, then the virtual ones

  // Derivative of the value of one chain joint by the coordinates z.
  const rate = chain.coordinates.map((index) => A[index]);

  function placeTree(q) {
    const T = [];
    tree.parents.forEach((parent, k) => {
      let placement = parent < 0 ? m.identity4() : m.times4(T[parent], tree.origins[k]);
      if (tree.kinds[k] !== 0)
        placement = m.times4(placement, m.motion4(tree.axes[k], tree.kinds[k] === 1, q[tree.coordinates[k]]));
      T.push(placement);
    });
    const back = m.inverse4(T[tree.base]);
    return T.map((placement) => m.times4(back, placement));
  }

  function sweep(values, point) {
    let T = m.identity4();
    const axes = [], origins = [], after = [];
    chain.axes.forEach((axis, k) => {
      T = m.times4(T, chain.placements[k]);
      T = m.times4(T, m.motion4(axis, chain.revolute[k], values[chain.coordinates[k]]));
      axes.push(m.turn4(T, axis));
      origins.push(m.position4(T));
      after.push(T);
    });
    const end = m.times4(T, chain.placements[chain.axes.length]);
    const position = m.move4(end, point);
    const linear = axes.map((axis, k) => (chain.revolute[k] ? m.cross(axis, m.minus(position, origins[k])) : axis));
    const angular = axes.map((axis, k) => (chain.revolute[k] ? axis : [0, 0, 0]));
    return { position, end, after, linear, angular };
  }

  function jacobian(screws) {
    const J = m.zeros(6, n);
    screws.linear.forEach((v, k) => {
      const w = screws.angular[k];
      rate[k].forEach((factor, j) => {
        if (factor !== 0)
          for (let i = 0; i < 3; i++) { J[i][j] += factor * v[i]; J[i + 3][j] += factor * w[i]; }
      });
    });
    return J;
  }

  // K_C[i][j] = F·(w_min × v_max) + M·(w_j × w_i) [j < i], then into coordinates: Gᵀ K_C G.
  function complementary(screws, wrench) {
    const force = wrench.slice(0, 3), moment = wrench.slice(3), count = rate.length;
    const K = m.zeros(count, count);
    for (let i = 0; i < count; i++)
      for (let j = i; j < count; j++) {
        K[i][j] = m.dot(force, m.cross(screws.angular[i], screws.linear[j]));
        K[j][i] = K[i][j];
        if (j > i) K[j][i] += m.dot(moment, m.cross(screws.angular[i], screws.angular[j]));
      }
    return m.times(m.transposed(rate), m.times(K, rate));
  }

  const torquesOf = (J, wrench) => m.apply(m.transposed(J), wrench);

  // (K_θ − K_C)⁻¹ = (I − C K_C)⁻¹ C, rigid coordinates included; null at the critical load.
  const loadedCompliance = (K_C) => m.solve(m.difference(m.identity(n), m.times(C, K_C)), C);

  function equilibrium(start, wrench, point) {
    let z = start.slice();
    for (let step = 0; step < 60; step++) {
      const screws = sweep(jointValues(z), point);
      const J = jacobian(screws), K_C = complementary(screws, wrench);
      const error = m.minus(m.minus(z, start), m.apply(C, torquesOf(J, wrench)));
      const change = m.solve(m.difference(m.identity(n), m.times(C, K_C)), error.map((e) => [e]));
      if (!change || !change.every((row) => Number.isFinite(row[0]))) return null;
      const largest = Math.max(0, ...change.map((row) => Math.abs(row[0])));
      if (largest <= 1e-12) return { z, position: screws.position };
      const factor = Math.min(1, 0.5 / largest);
      z = z.map((value, i) => value - factor * change[i][0]);
    }
    return null;
  }

  const axesOf = (J, compliance) => m.eigen(m.symmetric(m.times(J, m.times(compliance, m.transposed(J)))));

  function definiteness(matrix) {
    const { values } = m.eigen(m.symmetric(matrix));
    const threshold = 1e-12 * Math.max(...values.map(Math.abs));
    const positive = values.some((v) => v > threshold), negative = values.some((v) => v < -threshold);
    const zero = values.some((v) => Math.abs(v) <= threshold);
    if (positive && negative) return "indefinite";
    if (negative) return zero ? "negative semi-definite" : "negative definite";
    return zero || !positive ? "positive semi-definite" : "positive definite";
  }

  // Links when virtual joints move too: each link rides on its joint of the chain.
  function placeElastic(z, point) {
    const values = jointValues(z), links = placeTree(values);
    if (n === drives) return links;
    const { after } = sweep(values, point);
    return links.map((T, k) => {
      const anchor = tree.anchors[k];
      if (anchor < 0) return T;
      return m.times4(m.times4(after[anchor], m.inverse4(links[chain.carriers[anchor]])), T);
    });
  }

  function compute(request) {
    const { wrench, point, exaggeration } = request;
    const z = m.add(request.a.concat(new Array(n - drives).fill(0)), offset);
    const values = jointValues(z), screws = sweep(values, point), J = jacobian(screws);
    const K_C = complementary(screws, wrench), loaded = loadedCompliance(K_C);
    const torques = torquesOf(J, wrench), top = J.slice(0, 3), bottom = J.slice(3);
    if (!loaded) return null;
    const deflection = { conventional: m.apply(top, m.apply(C, torques)) };
    const rest = equilibrium(z, wrench, point);
    if (rest) deflection.equilibrium = m.minus(rest.position, screws.position);
    const { c, V } = yielding;
    const K_Csoft = m.symmetric(m.times(V, m.times(K_C, m.transposed(V))));
    // A negative spring: unstable before any load, and nothing has a share.
    const shares = c.every((value) => value > 0)
      ? m.eigen(K_Csoft.map((row, i) => row.map((value, j) => value * Math.sqrt(c[i] * c[j])))).values : null;
    const K_theta = c.map((value, i) => c.map((_, j) => (i === j ? 1 / value : 0)));
    const stable = definiteness(m.difference(K_theta, K_Csoft));
    // Else one step leads to a balance that never is.
    if (stable === "positive definite") deflection.enhanced = m.apply(top, m.apply(loaded, torques));
    return {
      links: placeElastic(z, point),
      deflected: rest && placeElastic(m.add(z, m.scaled(m.minus(rest.z, z), exaggeration)), point),
      position: screws.position,
      rotation: [0, 1, 2, 4, 5, 6, 8, 9, 10].map((k) => screws.end[k]),
      translation: { conventional: axesOf(top, C), enhanced: axesOf(top, loaded) },
      rotationAxes: { conventional: axesOf(bottom, C), enhanced: axesOf(bottom, loaded) },
      deflection,
      classes: {
        K_C: K_Csoft.some((row) => row.some((v) => v !== 0)) ? definiteness(K_Csoft) : "zero",
        stiffness: stable,
      },
      softening: shares && Math.max(0, shares[0]),
      stiffening: shares && Math.max(0, -shares[shares.length - 1]),
    };
  }

  return {
    compute,
    request(state, done) {
      const frame = compute(state);
      if (frame) done(frame);
      onState(...(frame ? ["open"] : ["refused", "this load is exactly critical"]));
    },
  };
};
