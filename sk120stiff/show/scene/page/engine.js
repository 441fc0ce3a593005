// The physics of a page without a server: stiffness under load from one serialised mechanism
// (show/mechanism.py), by the formulas of Python's stiffness/on_arrays.py.
"use strict";
SK.makeEngine = (mechanism, onState = () => {}) => {
  const m = SK.algebra;
  const { drives, A, b, shift, gravity, chain, tree, laws } = mechanism;
  const n = shift.length, count = chain.nodes.length, none = [0, 0, 0];
  const rate = chain.nodes.map((node) => A[tree.coordinates[node]]); // of a chain joint's value, by z

  // Compliance of the coordinates: constant, and Fourier series of what changes with the pose.
  function complianceAt(a) {
    const C = mechanism.compliance.map((row) => row.slice());
    for (const { at: [i, j], joints, orders, real, imaginary, inverse } of mechanism.terms) {
      let total = 0;
      orders.forEach((order, k) => {
        const phase = m.dot(order, joints.map((joint) => a[joint]));
        total += real[k] * Math.cos(phase) - imaginary[k] * Math.sin(phase);
      });
      const value = inverse ? 1 / total : total;
      C[i][j] += value;
      if (i !== j) C[j][i] += value;
    }
    return C;
  }

  // A law by its torque: what yields, and its slope. The arm's weight stands on it before the load comes.
  function shape({ kind, torque: T, side }, torque) {
    const size = Math.abs(torque);
    const [value, slope] = {
      square: [torque * size, 2 * size], cube: [torque ** 3, 3 * size ** 2], sign: [Math.sign(torque), 0],
      clip: [Math.min(Math.max(torque, -T), T), size < T ? 1 : 0], tanh: [Math.tanh(torque / T), 0],
      line: [torque, 1], size: [size, Math.sign(torque)],
      rising: size < T ? [torque * size / (2 * T), size / T] : [torque - Math.sign(torque) * T / 2, 1],
    }[kind];
    return [side ? side * Math.max(side * value, 0) : value, slope];
  }
  const straight = { tangent: (C) => C, add: (elongations) => elongations };
  const hardly = 1e-9 * chain.masses.reduce((sum, mass) => sum + mass, 0);
  function lawsAt(a, start, wrench, point) {
    if (!laws.length) return straight;
    const zero = [...none, ...none], onset = stateAt(start, wrench, point).torques;
    const hanging = stateAt(a.concat(new Array(n - drives).fill(0)), zero, point).hanging;
    const terms = laws.map((law) => {
      const weight = law.weight && Math.abs(hanging[law.at]) > hardly ? hanging[law.at] : 0;
      return { law, weight, before: shape(law, weight)[0] };
    });
    return {
      // Compliance with what these laws yield to a little more torque.
      tangent(C, torques) {
        const whole = C.map((row) => row.slice());
        for (const { law, weight } of terms)
          if (!law.switch) whole[law.at][law.at] += law.size * shape(law, (torques ? torques[law.at] : 0) + weight)[1];
        return whole;
      },
      add(elongations, torques) {
        for (const { law, weight, before } of terms)
          elongations[law.at] += law.size * (shape(law, (law.switch ? onset : torques)[law.at] + weight)[0] - before);
        return elongations;
      },
    };
  }

  // Placement of every link and virtual joint in the base frame.
  function place(z) {
    const q = m.add(m.apply(A, z), b), T = [];
    for (const k of tree.order) {
      T[k] = tree.parents[k] < 0 ? m.identity4() : m.times4(T[tree.parents[k]], tree.origins[k]);
      if (tree.kinds[k]) T[k] = m.times4(T[k], m.motion4(tree.axes[k], tree.kinds[k] === 1, q[tree.coordinates[k]]));
    }
    const back = m.inverse4(T[tree.base]);
    return T.map((placement) => m.times4(back, placement));
  }

  // Unit twists of the chain's joints at the point, and what each joint carries.
  function screwsAt(z, point) {
    const T = place(z), turns = chain.nodes.map((node) => tree.kinds[node] === 1);
    const end = m.times4(T[count ? chain.nodes[count - 1] : tree.base], chain.end), position = m.move4(end, point);
    const axes = chain.nodes.map((node) => m.turn4(T[node], tree.axes[node]));
    const origins = chain.nodes.map((node) => m.position4(T[node]));
    const linear = axes.map((axis, k) => (turns[k] ? m.cross(axis, m.minus(position, origins[k])) : axis));
    const angular = axes.map((axis, k) => (turns[k] ? axis : none));
    const carried = [];
    let mass = 0, moment = none;
    for (let k = count - 1; k >= 0 && gravity; k--) {
      mass += chain.masses[k];
      moment = m.add(moment, m.scaled(m.move4(T[chain.nodes[k]], chain.centres[k]), chain.masses[k]));
      carried[k] = turns[k] ? m.cross(axes[k], m.minus(moment, m.scaled(origins[k], mass))) : m.scaled(axes[k], mass);
    }
    return { T, end, position, linear, angular, carried };
  }

  const inCoordinates = (K) => m.times(m.transposed(rate), m.times(K, rate));

  // K[i][j] = F·(w_min × v_max) + M·(w_j × w_i) [j < i]: of a load, or of the weight with v carried.
  function complementary(angular, linear, force, moment) {
    const K = m.zeros(count, count);
    for (let i = 0; i < count; i++)
      for (let j = i; j < count; j++) {
        K[i][j] = K[j][i] = m.dot(force, m.cross(angular[i], linear[j]));
        if (j > i) K[j][i] += m.dot(moment, m.cross(angular[i], angular[j]));
      }
    return inCoordinates(K);
  }

  // Everything at coordinates z: J, K_C, K_g, torques of load and weight.
  function stateAt(z, wrench, point) {
    const screws = screwsAt(z, point), { linear, angular, carried } = screws;
    const columns = linear.map((v, k) => v.concat(angular[k]));
    const J = m.times(m.transposed(columns), rate);
    const hanging = gravity ? m.apply(m.transposed(rate), carried.map((c) => m.dot(gravity, c))) : new Array(n).fill(0);
    return {
      ...screws, J, hanging, torques: m.apply(m.transposed(J), wrench),
      K_C: complementary(angular, linear, wrench.slice(0, 3), wrench.slice(3)),
      K_g: gravity ? complementary(angular, carried, gravity, none) : m.zeros(n, n),
    };
  }

  // Exact equilibrium z = start + C (torques of load and weight) + laws, by Newton; null: none holds.
  function equilibrium(start, C, wrench, point, law) {
    let z = start.slice();
    for (let step = 0; step < 60; step++) {
      const state = stateAt(z, wrench, point), now = law.tangent(C, state.torques);
      const given = law.add(m.apply(C, m.add(state.torques, state.hanging)), state.torques);
      const error = m.minus(m.minus(z, start), given);
      const feedback = plus(m.times(now, state.K_C), m.times(C, state.K_g));
      const change = m.solve(m.difference(m.identity(n), feedback), error.map((e) => [e]));
      if (!change || !change.every((row) => Number.isFinite(row[0]))) return null;
      const largest = Math.max(0, ...change.map((row) => Math.abs(row[0])));
      if (largest <= 1e-12) return holds(now, plus(state.K_C, state.K_g)) ? { ...state, z } : null;
      z = z.map((value, i) => value - Math.min(1, 0.5 / largest) * change[i][0]);
    }
    return null;
  }

  const plus = (X, Y) => X.map((row, i) => m.add(row, Y[i]));
  const within = (V, K) => m.symmetric(m.times(V, m.times(K, m.transposed(V))));
  const axesOf = (J, C) => m.eigen(m.symmetric(m.times(J, m.times(C, m.transposed(J)))));

  // Principal compliances of what yields at all, and their directions as rows.
  function yielding(C) {
    const { values, directions } = m.eigen(m.symmetric(C));
    const largest = Math.max(0, ...values.map(Math.abs));
    const kept = values.map((value, k) => k).filter((k) => Math.abs(values[k]) > 1e-12 * largest);
    return { c: kept.map((k) => values[k]), V: kept.map((k) => directions[k]) };
  }

  // √c K √c: what loads take from the springs, as a share of them.
  const sharesOf = (c, K) => K.map((row, i) => row.map((value, j) => value * Math.sqrt(Math.abs(c[i] * c[j]))));

  function holds(C, K) {
    const { c, V } = yielding(C);
    return c.some((value) => value < 0) || m.eigen(sharesOf(c, within(V, K))).values.every((share) => share < 1);
  }

  // Largest and smallest share of the load, in what springs and weight leave; null without balance.
  function shares(c, K_C, K_g) {
    const left = m.eigen(m.difference(m.identity(c.length), sharesOf(c, K_g)));
    if (c.some((value) => value <= 0) || left.values.some((value) => value <= 1e-12)) return null;
    const by = left.directions.map((row, k) => m.scaled(row, 1 / Math.sqrt(left.values[k])));
    const { values } = m.eigen(within(by, sharesOf(c, K_C)));
    const noise = 1e-12 * Math.max(0, ...values.map(Math.abs));
    return [values[0] > noise ? values[0] : 0, Math.max(0, -values[values.length - 1])];
  }

  function definiteness(matrix) {
    const { values } = m.eigen(m.symmetric(matrix));
    const threshold = 1e-12 * Math.max(...values.map(Math.abs));
    const positive = values.some((v) => v > threshold), negative = values.some((v) => v < -threshold);
    const zero = values.some((v) => Math.abs(v) <= threshold);
    if (positive && negative) return "indefinite";
    if (negative) return zero ? "negative semi-definite" : "negative definite";
    return zero || !positive ? "positive semi-definite" : "positive definite";
  }

  function compute({ a, wrench, point, exaggeration }) {
    const springs = complianceAt(a), start = m.add(a.concat(new Array(n - drives).fill(0)), shift);
    const still = gravity ? equilibrium(start, springs, [...none, ...none], point, straight) : { z: start };
    if (!still) return null;
    const law = lawsAt(a, start, wrench, point), C = law.tangent(springs); // under small loads
    const { z } = still, { T, end, position, J, K_C, K_g, torques } = stateAt(z, wrench, point);
    const loaded = m.solve(m.difference(m.identity(n), m.times(C, plus(K_C, K_g))), C); // K⁻¹
    if (!loaded) return null;
    const top = J.slice(0, 3), bottom = J.slice(3), links = T.slice(0, tree.links);
    const deflection = { conventional: m.apply(top, m.apply(C, torques)) };
    const rest = equilibrium(start, springs, wrench, point, law);
    if (rest) deflection.equilibrium = m.minus(rest.position, position);
    const { c, V } = yielding(C), load = within(V, K_C), own = within(V, K_g);
    const taken = shares(c, load, own);
    const stable = definiteness(c.map((value, i) => c.map((_, j) => (i === j ? 1 / value : 0) - load[i][j] - own[i][j])));
    // Else one step leads to a balance that never is.
    if (stable === "positive definite") deflection.enhanced = m.apply(top, m.apply(loaded, torques));
    const moved = rest && m.add(z, m.scaled(m.minus(rest.z, z), exaggeration));
    return {
      links,
      deflected: rest && place(moved).slice(0, tree.links),
      position,
      rotation: [0, 1, 2, 4, 5, 6, 8, 9, 10].map((k) => end[k]),
      translation: { conventional: axesOf(top, C), enhanced: axesOf(top, loaded) },
      rotationAxes: { conventional: axesOf(bottom, C), enhanced: axesOf(bottom, loaded) },
      deflection,
      classes: { K_C: load.some((row) => row.some((v) => v !== 0)) ? definiteness(load) : "zero", stiffness: stable },
      softening: taken && taken[0],
      stiffening: taken && taken[1],
    };
  }

  return {
    compute,
    request(state, done) {
      const frame = compute(state);
      if (frame) done(frame);
      onState(...(frame ? ["open"] : ["refused", "this load is exactly critical, or the arm falls under its own weight"]));
    },
  };
};
