"""Eigenvalues of small symmetric matrices, for a block of poses or for one."""

from __future__ import annotations

import math

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel.compiled import part
from sk120stiff.stiffness.kernel.layout import BLOCK, EIGENVALUE, EIGENVECTOR, TENSOR

PD, PSD, ND, NSD, ID, UNKNOWN = 0, 1, 2, 3, 4, 255  # indices into `principal.CLASSES`
ZERO = 1e-12  # share of the largest below which an eigenvalue counts as zero, as in `principal`
SWEEPS = 30  # Jacobi's method needs about six


@part
def eigen(x: Array) -> None:
    """Eigenvalues (largest first) and unit vectors of the symmetric part of TENSOR.

    The eigenvalue furthest from the other two is q ± 2 p c, with c the root of 4 c³ − 3 c = r in
    [√3/2, 1], where it is well conditioned; the other two come from the 2×2 problem across its
    vector. So nearly equal eigenvalues lose nothing, unlike in the usual formula with an arc
    cosine.
    """
    for k in range(BLOCK):
        a01 = 0.5 * (x[(TENSOR + 1) * BLOCK + k] + x[(TENSOR + 3) * BLOCK + k])
        a02 = 0.5 * (x[(TENSOR + 2) * BLOCK + k] + x[(TENSOR + 6) * BLOCK + k])
        a12 = 0.5 * (x[(TENSOR + 5) * BLOCK + k] + x[(TENSOR + 7) * BLOCK + k])
        a00 = x[TENSOR * BLOCK + k]
        a11 = x[(TENSOR + 4) * BLOCK + k]
        a22 = x[(TENSOR + 8) * BLOCK + k]
        q = (a00 + a11 + a22) * (1.0 / 3.0)
        a00, a11, a22 = a00 - q, a11 - q, a22 - q
        off = a01 * a01 + a02 * a02 + a12 * a12
        p = math.sqrt((a00 * a00 + a11 * a11 + a22 * a22 + 2.0 * off) * (1.0 / 6.0))
        by = 1.0 / (p if p > 1e-150 else 1.0)
        b00, b11, b22 = a00 * by, a11 * by, a22 * by
        b01, b02, b12 = a01 * by, a02 * by, a12 * by
        det = b00 * (b11 * b22 - b12 * b12) - b01 * (b01 * b22 - b12 * b02)
        det += b02 * (b01 * b12 - b11 * b02)
        side = 1.0 if det >= 0.0 else -1.0
        far = 2.0 * side * _cosine_of_third(min(0.5 * abs(det), 1.0))
        # Its vector is across two rows of B − far·I: take the longest of the three cross products.
        d0, d1, d2 = b00 - far, b11 - far, b22 - far
        ux, uy, uz = b01 * b12 - b02 * d1, b02 * b01 - d0 * b12, d0 * d1 - b01 * b01
        vx, vy, vz = d1 * d2 - b12 * b12, b12 * b02 - b01 * d2, b01 * b12 - d1 * b02
        wx, wy, wz = b12 * b02 - d2 * b01, d2 * d0 - b02 * b02, b02 * b01 - b12 * d0
        u, v = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
        w = wx * wx + wy * wy + wz * wz
        more = v > u
        ux, uy, uz = vx if more else ux, vy if more else uy, vz if more else uz
        u = v if more else u
        more = w > u
        ux, uy, uz = wx if more else ux, wy if more else uy, wz if more else uz
        u = w if more else u
        none = not u > 1e-30  # three equal eigenvalues: any direction serves
        by = 1.0 / math.sqrt(1.0 if none else u)
        ux, uy, uz = 0.0 if none else ux * by, 0.0 if none else uy * by, 1.0 if none else uz * by
        # Two unit vectors across u (Duff et al. 2017), and the 2×2 problem in them.
        sign = math.copysign(1.0, uz)
        f = -1.0 / (sign + uz)
        g = ux * uy * f
        vx, vy, vz = 1.0 + sign * ux * ux * f, sign * g, -sign * ux
        wx, wy, wz = g, sign + uy * uy * f, -uy
        far = _form(a00, a01, a02, a11, a12, a22, ux, uy, uz, ux, uy, uz)
        m11 = _form(a00, a01, a02, a11, a12, a22, vx, vy, vz, vx, vy, vz)
        m12 = _form(a00, a01, a02, a11, a12, a22, vx, vy, vz, wx, wy, wz)
        m22 = _form(a00, a01, a02, a11, a12, a22, wx, wy, wz, wx, wy, wz)
        half, mean = 0.5 * (m11 - m22), 0.5 * (m11 + m22)
        root = math.sqrt(half * half + m12 * m12)
        c = half + root if half >= 0.0 else m12
        s = m12 if half >= 0.0 else root - half
        length = math.sqrt(c * c + s * s)
        same = not length > 0.0
        by = 1.0 / (1.0 if same else length)
        c, s = 1.0 if same else c * by, s * by
        hx, hy, hz = c * vx + s * wx, c * vy + s * wy, c * vz + s * wz
        lx, ly, lz = c * wx - s * vx, c * wy - s * vy, c * wz - s * vz
        top = side > 0.0
        x[EIGENVALUE * BLOCK + k] = q + (far if top else mean + root)
        x[(EIGENVALUE + 1) * BLOCK + k] = q + (mean + root if top else mean - root)
        x[(EIGENVALUE + 2) * BLOCK + k] = q + (mean - root if top else far)
        x[EIGENVECTOR * BLOCK + k] = ux if top else hx
        x[(EIGENVECTOR + 1) * BLOCK + k] = uy if top else hy
        x[(EIGENVECTOR + 2) * BLOCK + k] = uz if top else hz
        x[(EIGENVECTOR + 3) * BLOCK + k] = hx if top else lx
        x[(EIGENVECTOR + 4) * BLOCK + k] = hy if top else ly
        x[(EIGENVECTOR + 5) * BLOCK + k] = hz if top else lz
        x[(EIGENVECTOR + 6) * BLOCK + k] = lx if top else ux
        x[(EIGENVECTOR + 7) * BLOCK + k] = ly if top else uy
        x[(EIGENVECTOR + 8) * BLOCK + k] = lz if top else uz


@part
def _cosine_of_third(r: float) -> float:
    """cos(arccos(r) / 3) for 0 ≤ r ≤ 1: a Chebyshev fit good to 3e-8, and one step of Newton."""
    c = -1.42717886e-02 + r * (7.65913990e-03 + r * (-2.93103643e-03 + r * 5.47794561e-04))
    c = 1.66664558e-01 + r * (-4.80733372e-02 + r * (2.43792590e-02 + r * c))
    c = 8.66025432e-01 + r * c
    return c - ((4.0 * c * c - 3.0) * c - r) / (12.0 * c * c - 3.0)


@part
def _form(
    a00: float, a01: float, a02: float, a11: float, a12: float, a22: float,
    ux: float, uy: float, uz: float, vx: float, vy: float, vz: float,
) -> float:  # fmt: skip
    """uᵀ A v."""
    fx, fy = a00 * vx + a01 * vy + a02 * vz, a01 * vx + a11 * vy + a12 * vz
    return ux * fx + uy * fy + uz * (a02 * vx + a12 * vy + a22 * vz)


@part
def jacobi(A: Array, s: int) -> None:
    """Diagonalise a symmetric A (s, s) in place by Jacobi's rotations; its diagonal remains."""
    for _ in range(SWEEPS):
        off, size = 0.0, 0.0
        for i in range(s):
            size += A[i, i] * A[i, i]
            for j in range(i):
                off += A[i, j] * A[i, j]
        if off <= 1e-34 * size or not off > 0.0:
            return
        for p in range(s):
            for q in range(p + 1, s):
                if A[p, q] == 0.0:
                    continue
                half = 0.5 * (A[q, q] - A[p, p]) / A[p, q]
                t = math.copysign(1.0, half) / (abs(half) + math.sqrt(1.0 + half * half))
                c = 1.0 / math.sqrt(1.0 + t * t)
                sine = t * c
                change = t * A[p, q]
                A[p, p] -= change
                A[q, q] += change
                A[p, q] = A[q, p] = 0.0
                for i in range(s):
                    if i != p and i != q:
                        f, g = A[i, p], A[i, q]
                        A[i, p] = A[p, i] = c * f - sine * g
                        A[i, q] = A[q, i] = sine * f + c * g


@part
def classify(A: Array) -> int:
    """Class of a symmetric A (s, s), which is destroyed; see `principal.definiteness`.

    Most matrices are told by one 2×2 minor: its eigenvalues lie between those of A.
    """
    s = A.shape[0]
    size = 0.0
    for i in range(s):
        for j in range(s):
            size += A[i, j] * A[i, j]
    if math.isnan(size):
        return UNKNOWN
    size = 10.0 * ZERO * math.sqrt(size)
    for i in range(s):
        for j in range(i):
            mean, half = 0.5 * (A[i, i] + A[j, j]), 0.5 * (A[i, i] - A[j, j])
            root = math.sqrt(half * half + A[i, j] * A[i, j])
            if mean + root > size and mean - root < -size:
                return ID
    jacobi(A, s)
    size = 0.0
    for i in range(s):
        size = max(size, abs(A[i, i]))
    positive, negative = 0, 0
    for i in range(s):
        positive += A[i, i] > ZERO * size
        negative += A[i, i] < -ZERO * size
    if positive and negative:
        return ID
    if negative:
        return ND if negative == s else NSD
    return PD if positive == s else PSD
