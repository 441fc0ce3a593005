"""What a calibration leaves beyond the noise: how much, in numbers and in words."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import stats

from sk120stiff.arrays import rms
from sk120stiff.errors import micro
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.noise.model_form import ModelForm
from sk120stiff.identify.positions.residuals.pure_error import pure_error
from sk120stiff.model.uncertainty import Remainder

LEVEL = 0.01  # probability of noise alone below which what is left is significant
ENDS = (0.975, 0.025)  # of an interval that holds 95 %
ONE_ERROR = 0.16  # probability of less, one standard error below

Size = tuple[float, float, float]  # best value and 95 % interval


def beyond(final: Calibration, sigma: float) -> Size:
    """Rms per axis beyond a stated noise [m].

    Readings that scatter less than was stated by chance exclude no more than others: the upper end
    is at least what noise alone would hide (power-constrained, Cowan et al. 2011).
    """
    square, freedom = final.judged
    freedom = max(freedom, 1)
    high, low = (float(stats.chi2.ppf(level, freedom)) for level in ENDS)
    shares = square / freedom, square / high, max(square / low, high / freedom)
    best, least, most = (sigma * max(share - 1.0, 0.0) ** 0.5 for share in shares)
    return best, least, most


def smooth_part(final: Calibration, form: ModelForm) -> Size:
    """Rms per axis of the smooth error where no noise is stated [m]."""
    gap = final.problem.of_channels.undo(final.residual)
    whole = len(gap) / max(final.degrees_of_freedom, 1)
    own = gap[final.problem.counted]
    best = float(np.sqrt(np.mean(own**2) * form.share * whole))
    ends = [(form.smooth / float(stats.chi2.ppf(level, form.smooth))) ** 0.5 for level in ENDS]
    return best, best * ends[0], best * ends[1]


def common_part(final: Calibration) -> Size:
    """Rms per axis of what the readings of a pose have in common [m].

    That is what the gap holds beyond the noise, as stated or as differences within poses tell it,
    an error that is smooth over the joints among it. Of its 95 % interval every pose counts as
    often as its joints move it, less what was estimated; of what is smooth, as independent numbers.
    """
    problem = final.problem
    white, counted = problem.of_channels, problem.counted
    square = white.undo(final.residual)[counted] ** 2
    noise = ((1.0 if final.sigma_known else final.unit) * white.sigma[counted]) ** 2
    poses = len(np.unique(problem.load_cases.pose))
    each = min(len(problem.rows) // poses, problem.by_joints.shape[1])
    freedom: float = max(poses * each - final.estimated, 1)
    best = float(np.sqrt(max(float(np.mean(square - noise)), 0.0) * poses * each / freedom))
    if final.form is not None:
        freedom = min(freedom, final.form.smooth)
    low, high = (best * (freedom / float(stats.chi2.ppf(q, freedom))) ** 0.5 for q in ENDS)
    return best, low, high


def left_beyond_noise(final: Calibration) -> Size | None:
    """Rms per axis beyond the noise and its 95 % interval; None where nothing tells the two.

    Of these readings it is no more than the gap; what was estimated took a part of it, which other
    poses show, and the upper end holds.
    """
    form, stated = final.form, final.problem.stated_sigma
    if final.problem.common:
        size = common_part(final)
    elif final.sigma_known and stated is not None:
        size = beyond(final, stated)
    elif form is not None:
        size = smooth_part(final, form)
    else:
        return None
    gap = final.problem.of_channels.undo(final.residual)[final.problem.counted]
    whole = rms(gap)
    best, low, high = size
    return min(best, whole), min(low, whole), high


def chance_of_noise(final: Calibration) -> float | None:
    """Probability that noise alone leaves as much; None where nothing tells the two apart."""
    if final.sigma_known and final.misfit is not None:
        return final.misfit[2]
    chances = [] if final.form is None else [final.form.chance]
    if final.problem.common:
        chances.append(final.chance_of_common)
    return min(chances, default=None)


def remainder_at_other_poses(final: Calibration) -> Remainder | None:
    """What is left, as predictions need it: as large whatever hangs on the arm; None: unknown.

    Where no noise is stated repeats tell how much of the gap is none. Without them it may be noise
    or what the model lacks: all of it is the most that is missing, and noise explains it as well.
    """
    size, chance = left_beyond_noise(final), chance_of_noise(final)
    if not len(final.problem.lengths) or final.degrees_of_freedom < 1:
        return None
    if size is None or chance is None:
        best, more, chance = _of_the_gap(final)
    else:
        best, _, high = size
        more = (best**2 + 0.5 * (high**2 - best**2)) ** 0.5  # half of an interval: a standard error
    return Remainder(
        rms=np.full(3, best),
        upper=np.full(3, more),
        freedom=np.full(3, max(final.degrees_of_freedom, 0) / 3.0),
        load=1.0,
        length=1.0,
        grows=False,
        probability=chance,
        significant=chance < LEVEL,
    )


def _of_the_gap(final: Calibration) -> Size:
    """Rms beyond the noise per axis and its upper limit [m], and the chance of noise.

    The lack-of-fit test (Draper & Smith 1998, ch. 2): what the gap holds beyond the pure error of
    repeats, over that error. Numbers that were read m times err by what is missing all alike.
    """
    numbers, freedom, again = len(final.problem.rows), final.degrees_of_freedom, pure_error(final)
    square = numbers * final.rms**2
    if again is None or freedom <= again.freedom:
        return 0.0, float(np.sqrt(square / freedom)), 1.0
    pure, others = again.sigma**2, freedom - again.freedom
    ratio = max(square - again.freedom * pure, 0.0) / others / pure
    times = numbers / (numbers - again.freedom)
    least = float(stats.f.ppf(ONE_ERROR, others, again.freedom))
    best, more = (
        float(np.sqrt(pure * max(each - 1.0, 0.0) / times)) for each in (ratio, ratio / least)
    )
    return best, more, float(stats.f.sf(ratio, others, again.freedom))


def remainder_entry(final: Calibration) -> dict[str, Any]:
    """What is left as callers rely on it."""
    size, chance = left_beyond_noise(final), chance_of_noise(final)
    um: list[float | None] = [None] * 3
    if size is not None and len(final.problem.lengths):
        um = [1e6 * x for x in size]
    return {
        "rms_um": um[0],
        "interval_95": um[1:],
        "p": chance,
        "significant": bool(chance is not None and chance < LEVEL),
    }


def remainder_sentences(final: Calibration) -> list[str]:
    """How much is left beyond the noise, where something tells."""
    size = left_beyond_noise(final)
    if size is None:
        return []
    unit, stated = final.problem.rms_unit, final.sigma_known
    own_course = "each pose is off by something of its own, as gears and bearings make it."
    said = []
    if stated:
        said.append(in_words(size, unit, stated=True))
    elif final.form is not None and not final.problem.common:
        said.append(in_words(size, unit, stated=False))
    if final.problem.common and stated:
        said.append(
            f"The readings of a pose have it in common, and no law explains it: {own_course}"
        )
    elif final.problem.common:
        best, low, high = map(micro, size)
        smooth = "part of it is smooth over the joints, as an error of the model is, and "
        said.append(
            f"The readings of a pose have {best} {unit} (95 %: {low} to {high}) in common that no "
            f"law explains: {smooth if final.form is not None else ''}{own_course}"
        )
    chance = chance_of_noise(final)
    alone = stated and not (final.form or final.problem.common or final.lacks)
    if alone and chance is not None and chance < LEVEL:
        square, freedom = final.judged
        said.append(
            "It has no smooth course over the joints, as an error of the model has: rather the "
            f"stated σ is {(square / max(freedom, 1)) ** 0.5:.2g} times too small. Repeat some "
            "poses, and the noise is known from them."
        )
    return said


def in_words(size: Size, unit: str, *, stated: bool) -> str:
    """How much is left beyond the noise, in a sentence; `unit` as `PoseProblem.rms_unit`."""
    best, low, high = map(micro, size)
    if not stated:
        return (
            f"What is left is mostly smooth over the joints, as an error of the model is and noise "
            f"is not: {best} {unit} (95 %: {low} to {high})."
        )
    if size[0] == 0.0:
        return (
            f"Nothing is left beyond the stated noise; more than {high} {unit} is excluded (95 %)."
        )
    return f"Left beyond the stated noise are {best} {unit} (95 %: {low} to {high})."
