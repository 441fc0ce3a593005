"""Several models of the same readings in one table; no difference without its standard error."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.identify.checks.held_out import HeldOut, held_out, refitted
from sk120stiff.identify.estimate import as_seen, fit_displacements, likelier, support
from sk120stiff.identify.fit import Fit
from sk120stiff.measurements import Measurements, NoiseModel, candidates
from sk120stiff.model import CALIBRATED, Model

CLEAR = 2.0  # standard errors from which on a difference is called one


@dataclass(frozen=True, eq=False)
class Compared:
    """One line of the table.

    Attributes:
        name: Name of the model.
        fit: It, fitted to all readings.
        held_out: Its error at poses left out; None where there is only one pose.
        aic, bic: Criteria above the least of all models.
        loss, loss_std: Held-out rms above that of the best model, and its standard error over poses
            [m].
        note: What to think of it, in words.
    """

    name: str
    fit: Fit
    held_out: HeldOut | None
    aic: float
    bic: float
    loss: float | None
    loss_std: float | None
    note: str


def compare(
    models: Mapping[str, Model],
    measurements: Measurements,
    *,
    noise: NoiseModel | None = None,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Compared, ...]:
    """Fit models to the same readings under the same noise, and rank them by held-out error.

    Args:
        models: Models by name.
        measurements: Readings with displacements.
        noise: Covariance for all; default: what the data say of themselves, those of the other
            poses where poses are left out.
        seed: Of the parts in which poses are left out.
        progress: Called as ``progress(done, total)``.

    Returns:
        tuple of Compared: Best held-out error first (of equals, least BIC); by BIC where there is
            only one pose.

    Raises:
        InputError: Fewer than two models, or readings that cannot be used.
        Refusal: A model could not be fitted; its name is given.
    """
    if len(models) < 2:
        raise InputError("a comparison takes two models or more")
    robot = next(iter(models.values())).robot
    used = as_seen(robot, measurements).masked()
    fits = _fits(models, used, [noise] if noise is not None else candidates(used))
    errors: dict[str, HeldOut | None] = {}
    for k, (name, model) in enumerate(models.items()):
        errors[name] = (
            held_out(used, refitted(model, noise=noise), seed=seed)[0]
            if len(used.poses) > 1
            else None
        )
        if progress is not None:
            progress(k + 1, len(models))

    def rank(name: str) -> tuple[float, float]:
        error = errors[name]
        return (0.0 if error is None else error.rms), fits[name].bic

    order = sorted(models, key=rank)
    least_aic = min(found.aic for found in fits.values())
    least_bic = min(found.bic for found in fits.values())
    lines = []
    for name in order:
        error, best = errors[name], errors[order[0]]
        loss, std = (None, None) if error is None or best is None else error.difference(best)
        found = fits[name]
        note = _note(found, loss, std, first=name == order[0], bic=found.bic - least_bic)
        lines.append(
            Compared(
                name, found, error, found.aic - least_aic, found.bic - least_bic, loss, std, note
            )
        )
    return tuple(lines)


def _fits(
    models: Mapping[str, Model], used: Measurements, noises: Sequence[NoiseModel]
) -> dict[str, Fit]:
    """All models under the noise under which the best of them is likelier."""
    tried = [
        {name: fit_displacements(m, used, noise=noise) for name, m in models.items()}
        for noise in noises
    ]
    best = [max(fits.values(), key=lambda found: found.log_likelihood) for fits in tried]
    return tried[likelier(support(best))]


def _note(found: Fit, loss: float | None, std: float | None, *, first: bool, bic: float) -> str:
    if first:
        said = "best"
    elif loss is None or std is None:
        said = "cannot be held against other poses"
    elif loss > CLEAR * std:
        said = "worse"
    else:
        said = "not told from the best"
    said += ", least BIC" if bic == 0.0 else ""
    lost = int((~found.identifiable).sum())
    shared = sum(p.origin == CALIBRATED for p in found.parameters)
    bound = int(found.at_bound.sum())
    far = int((np.abs(found.x) > found.problem.plausible).sum())
    for count, what in (
        (lost, "not identifiable"),
        (shared, "known up to a calibration"),
        (bound, "on a bound"),
        (far, "implausible"),
    ):
        said += f"; {count} {what}" if count else ""
    return said
