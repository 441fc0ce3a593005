"""Gross mistakes in the data, looked for before physics is blamed.

A passive arm yields along the load, and its compliances are not negative. With S the displacements
of unit compliances and d the readings, ``min ‖d − S c‖, c ≥ 0`` leaves little of d on good data,
even where effects are missing that the model does not know. Readings for which it leaves most of d,
but for which it fits once a sign is turned or two axes are swapped, were written down wrongly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from sk120stiff.effects import Situation, situation_of
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.robot.coupling import Array

POOR, GOOD = 0.8, 0.85  # explained shares of ‖d‖²: little like this arm, and clearly like it
CLEARER = 10.0  # times as much that is unexplained as after the correction
SPARE = 6  # numbers beyond the springs that it takes to judge a fit
FACTOR = 200.0  # no arm is so much softer or stiffer than its model; a unit is


def mistakes(model: Model, measurements: Measurements) -> tuple[str, ...]:
    """What looks written down wrongly, in sentences; empty where nothing does.

    Parameters
    ----------
    model
        The base model; its elastic effects decide what a passive arm could do.
    measurements
        Readings with displacements. Masked rows are left out.
    """
    used = measurements.masked()
    if used.displacement is None:
        return ()
    situation = situation_of(model.robot, used)
    d, S = used.displacement, _unit_displacements(model, situation)
    if d.size < S.shape[2] + SPARE or not S.shape[2] or not d.any():
        return ()
    share, c = _explained(S, d)
    if share > POOR:
        return _units(model, S, c)
    best, said = max(_alternatives(model, situation, d, S), key=lambda item: item[0])
    if best < GOOD or (1.0 - share < CLEARER * (1.0 - best) and share > 0.5):
        return ()
    return (f"{said} (the springs then explain {best:.0%} of the readings, else {share:.0%})",)


def repeated_rows(measurements: Measurements) -> NDArray[np.intp]:
    """(k,) rows that repeat an earlier one to the last digit, load and all three axes.

    Such rows are copies, not repeats: the noise that they claim to show is zero. Rows that the file
    itself tells apart, by order, time, branch or repeat, are readings of their own.
    """
    if measurements.displacement is None:
        return np.zeros(0, dtype=np.intp)
    whole = np.column_stack([measurements.joints, measurements.wrench, measurements.displacement])
    first: dict[tuple[bytes, tuple[object, ...]], int] = {}
    copies = []
    for row in np.flatnonzero(measurements.use):
        if not measurements.displacement[row].all():
            continue
        told_apart = tuple(
            None if column is None else column[row]
            for column in (
                measurements.order,
                measurements.time,
                measurements.branch,
                measurements.repeat,
            )
        )
        key = ((whole[row] + 0.0).tobytes(), told_apart)
        if first.setdefault(key, int(row)) != row:
            copies.append(row)
    return np.array(copies, dtype=np.intp)


def without_copies(measurements: Measurements) -> tuple[Measurements, str | None]:
    """The readings with copied rows masked, and the sentence that says so."""
    copies = repeated_rows(measurements)
    if not len(copies):
        return measurements, None
    use = measurements.use.copy()
    use[copies] = False
    lines = [str(measurements.line[row]) for row in copies[:5]]
    more = " …" if len(copies) > 5 else ""
    said = (
        f"{len(copies)} rows repeat earlier ones to the last digit "
        f"(line {', '.join(lines)}{more}). Copies show no noise, so they are masked here."
    )
    return replace(measurements, use=use), said


def _unit_displacements(model: Model, situation: Situation) -> Array:
    """(N, 3, k) displacement for each unit compliance of the model, to first order."""
    elastic = [k for k, p in enumerate(model.parameters) if p.spec.reciprocal]
    _, S = model.predict_with_sensitivities(situation, np.zeros(len(model.values)))
    return np.asarray(S[:, :, elastic])


def _explained(S: Array, d: Array) -> tuple[float, Array]:
    """Share of ‖d‖² that compliances from zero up explain, and these."""
    A = S.reshape(d.size, -1)
    scale = np.linalg.norm(A, axis=0)
    seen = scale > 1e-9 * scale.max(initial=0.0)
    c = np.zeros(len(scale))
    if seen.any():
        found, left = nnls(A[:, seen] / scale[seen], d.ravel())
        c[seen] = found / scale[seen]
        return 1.0 - left**2 / float(d.ravel() @ d.ravel()), c
    return 0.0, c


def _units(model: Model, S: Array, c: Array) -> tuple[str, ...]:
    """Is everything softer or stiffer than the model by a factor that no arm has?"""
    given = np.array([v for v, p in zip(model.values, model.parameters, strict=True)
                      if p.spec.reciprocal])  # fmt: skip
    ours, theirs = np.linalg.norm(S @ c), np.linalg.norm(S @ given)
    if theirs == 0.0 or 1.0 / FACTOR < ours / theirs < FACTOR:
        return ()
    ratio = ours / theirs
    said = f"{ratio:.0f} times" if ratio > 1.0 else f"1/{1.0 / ratio:.0f} of"
    return (
        f"the displacements are {said} what the model's springs give: "
        "check the units in the headers of displacement and force",
    )


def _alternatives(
    model: Model, situation: Situation, d: Array, S: Array
) -> Iterator[tuple[float, str]]:
    """Share explained after each correction, and the sentence that asks for it."""
    against = int((np.einsum("ni,ni->n", situation.wrench[:, :3], _base(situation, d)) < 0).sum())
    yield (
        _explained(S, -d)[0],
        f"displacement and force point against each other in {against} of {len(d)} rows: "
        "check the sign convention",
    )
    for axis, name in enumerate("xyz"):
        signs = np.ones(3)
        signs[axis] = -1.0
        yield _explained(S, d * signs)[0], f"d{name} seems to have the wrong sign"
        load = np.tile(signs, 2) if situation.wrench[:, 3:].any() else np.append(signs, np.ones(3))
        turned = replace(situation, wrench=situation.wrench * load)
        share = _explained(_unit_displacements(model, turned), d)[0]
        yield share, f"f{name} seems to have the wrong sign"
    for order in list(itertools.permutations(range(3)))[1:]:
        names = ", ".join("xyz"[k] for k in order)
        yield (
            _explained(S, d[:, order])[0],
            f"the axes of the displacement seem to be swapped: dx, dy, dz look like {names}",
        )
        swapped = np.concatenate([order, [3 + k for k in order]])
        turned = replace(situation, wrench=situation.wrench[:, swapped])
        share = _explained(_unit_displacements(model, turned), d)[0]
        yield share, f"the axes of the force seem to be swapped: fx, fy, fz look like {names}"


def _base(situation: Situation, d: Array) -> Array:
    """Displacements in base axes (N, 3)."""
    turned: Array = np.einsum("nij,nj->ni", situation.reading_axes, d)
    return turned
