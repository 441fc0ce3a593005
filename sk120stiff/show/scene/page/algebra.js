// Small linear algebra. Transforms are 16 numbers, column by column; other matrices are rows.
"use strict";
const SK = window.SK = {};

SK.algebra = (() => {
  const identity4 = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

  function times4(a, b) {
    const c = new Array(16);
    for (let j = 0; j < 4; j++)
      for (let i = 0; i < 4; i++)
        c[4 * j + i] = a[i] * b[4 * j] + a[4 + i] * b[4 * j + 1] + a[8 + i] * b[4 * j + 2] + a[12 + i] * b[4 * j + 3];
    return c;
  }

  // Inverse of a rotation with a translation.
  function inverse4(t) {
    const r = [t[0], t[4], t[8], 0, t[1], t[5], t[9], 0, t[2], t[6], t[10], 0, 0, 0, 0, 1];
    const p = [t[12], t[13], t[14]];
    for (let i = 0; i < 3; i++) r[12 + i] = -(r[i] * p[0] + r[4 + i] * p[1] + r[8 + i] * p[2]);
    return r;
  }

  // Rotation about, or slide along, a unit axis.
  function motion4(axis, revolute, value) {
    const t = identity4();
    const [x, y, z] = axis;
    if (!revolute) {
      t[12] = value * x; t[13] = value * y; t[14] = value * z;
      return t;
    }
    const s = Math.sin(value), v = 1 - Math.cos(value);
    t[0] = 1 - v * (y * y + z * z); t[4] = v * x * y - s * z; t[8] = v * x * z + s * y;
    t[1] = v * x * y + s * z; t[5] = 1 - v * (x * x + z * z); t[9] = v * y * z - s * x;
    t[2] = v * x * z - s * y; t[6] = v * y * z + s * x; t[10] = 1 - v * (x * x + y * y);
    return t;
  }

  const position4 = (t) => [t[12], t[13], t[14]];
  const turn4 = (t, v) => [0, 1, 2].map((i) => t[i] * v[0] + t[4 + i] * v[1] + t[8 + i] * v[2]);
  const move4 = (t, p) => turn4(t, p).map((value, i) => value + t[12 + i]);
  const add = (a, b) => a.map((value, i) => value + b[i]);
  const minus = (a, b) => a.map((value, i) => value - b[i]);
  const scaled = (a, factor) => a.map((value) => factor * value);
  const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
  const norm = (a) => Math.sqrt(dot(a, a));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

  const zeros = (rows, columns) => Array.from({ length: rows }, () => new Array(columns).fill(0));
  const identity = (n) => zeros(n, n).map((row, i) => { row[i] = 1; return row; });
  const transposed = (A) => (A.length ? A[0].map((_, j) => A.map((row) => row[j])) : []);
  const times = (A, B) => {
    const columns = transposed(B);
    return A.map((row) => columns.map((column) => dot(row, column)));
  };
  const apply = (A, x) => A.map((row) => dot(row, x));
  const difference = (A, B) => A.map((row, i) => minus(row, B[i]));
  const symmetric = (A) => A.map((row, i) => row.map((value, j) => 0.5 * (value + A[j][i])));

  // X with A X = B, by elimination with row pivots; null where A is singular.
  function solve(A, B) {
    const n = A.length, width = n + B[0].length;
    const M = A.map((row, i) => row.concat(B[i]));
    for (let k = 0; k < n; k++) {
      let pivot = k;
      for (let i = k + 1; i < n; i++) if (Math.abs(M[i][k]) > Math.abs(M[pivot][k])) pivot = i;
      if (!(Math.abs(M[pivot][k]) > 0)) return null;
      [M[k], M[pivot]] = [M[pivot], M[k]];
      for (let i = k + 1; i < n; i++) {
        const factor = M[i][k] / M[k][k];
        if (factor !== 0) for (let j = k; j < width; j++) M[i][j] -= factor * M[k][j];
      }
    }
    for (let k = n - 1; k >= 0; k--)
      for (let j = n; j < width; j++) {
        for (let i = k + 1; i < n; i++) M[k][j] -= M[k][i] * M[i][j];
        M[k][j] /= M[k][k];
      }
    return M.map((row) => row.slice(n));
  }

  // Eigenvalues of a symmetric matrix, largest first, with unit vectors as rows: Jacobi's rotations.
  function eigen(symmetricMatrix) {
    const n = symmetricMatrix.length;
    const A = symmetricMatrix.map((row) => row.slice()), V = identity(n);
    for (let sweep = 0; sweep < 60; sweep++) {
      let off = 0, size = 0;
      for (let i = 0; i < n; i++)
        for (let j = 0; j < n; j++) (i === j ? (size += A[i][j] ** 2) : (off += A[i][j] ** 2));
      if (off <= 1e-32 * (size + off)) break;
      for (let p = 0; p < n - 1; p++)
        for (let q = p + 1; q < n; q++) {
          if (A[p][q] === 0) continue;
          const theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
          const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
          const c = 1 / Math.sqrt(t * t + 1), s = t * c;
          for (let k = 0; k < n; k++) {
            const akp = A[k][p], akq = A[k][q];
            A[k][p] = c * akp - s * akq;
            A[k][q] = s * akp + c * akq;
          }
          for (let k = 0; k < n; k++) {
            const apk = A[p][k], aqk = A[q][k];
            A[p][k] = c * apk - s * aqk;
            A[q][k] = s * apk + c * aqk;
            const vpk = V[p][k], vqk = V[q][k];
            V[p][k] = c * vpk - s * vqk;
            V[q][k] = s * vpk + c * vqk;
          }
        }
    }
    const order = A.map((_, i) => i).sort((i, j) => A[j][j] - A[i][i]);
    return { values: order.map((i) => A[i][i]), directions: order.map((i) => V[i]) };
  }

  return {
    identity4, times4, inverse4, motion4, position4, turn4, move4, add, minus, scaled, dot, norm, cross,
    zeros, identity, transposed, times, apply, difference, symmetric, solve, eigen,
  };
})();
