"""The chosen fitted exactly, judged beside what is left, and changed until they stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sk120stiff.effects import Catalogue, Effect
from sk120stiff.errors import InputError, Refusal
from sk120stiff.explain.positions.judge.accounts import rms
from sk120stiff.explain.positions.judge.fallen import with_one_less
from sk120stiff.explain.positions.judge.laws import Laws, as_fitted, by_best_laws, laws_at
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.judge.smooth_error import beside_any
from sk120stiff.explain.positions.select.choose import Chosen
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.select.form import with_best_form
from sk120stiff.identify.positions.calibrate import (
    Calibration,
    refined,
    with_model_form,
    with_values_of,
)
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model

MORE = 1.2  # times as much left as to first order: the fit went another way


@dataclass(frozen=True, eq=False)
class Standing:
    """Names, the fit with them, and how probable they are.

    Attributes:
        linear: The positions to first order, by the laws that were fitted, beside what is left.
        found: The names.
        laws: Their laws.
        final: The fit.
    """

    linear: Linear
    found: Chosen
    laws: Laws
    final: Calibration

    @cached_property
    def posterior(self) -> Posterior:
        """The names beside all sets near them."""
        return Posterior(self.linear, self.found.order)

    @property
    def picked(self) -> list[Effect]:
        """The named effects."""
        return picked(self.linear, self.found)


@dataclass(frozen=True, eq=False)
class Campaign:
    """Readings, and the calibrations about which names are looked for.

    Attributes:
        base: The registered arm.
        seen: What names were last seen about.
        readings: The readings.
        catalogue: Where effects come from.
    """

    base: Calibration
    seen: Calibration
    readings: Measurements
    catalogue: Catalogue

    def exactly(self, linear: Linear, found: Chosen) -> Calibration:
        """The chosen fitted at equilibrium, from where they were seen.

        A load on springs is a product of two unknowns, and the way to it is curved: where more is
        left than to first order, the values found so are another start.
        """
        base, seen, readings, catalogue = self.base, self.seen, self.readings, self.catalogue
        effects = picked(linear, found)

        def again_with(model: Model, effects: Sequence[Effect], _: Calibration) -> Calibration:
            return refined(base, effects, readings, model, catalogue)

        final = refined(base, effects, readings, seen.model, catalogue)
        noise = linear.noise(found.order)
        foretold = linear.gap(found.order, noise, held_out=False)
        foretold = seen.problem.of_channels.undo(foretold)
        if left(final) <= MORE * rms(foretold):
            return with_best_form(effects, final, again_with)[1]
        known = linear.values(found.order, noise)
        wide = final.model
        values = [
            known.get(p.name, p.internal) for p in with_values_of(wide, seen.model).parameters
        ]
        again = refined(base, effects, readings, wide.with_values(np.array(values)), catalogue)
        return with_best_form(effects, min(final, again, key=left), again_with)[1]

    def standing(self, linear: Linear, found: Chosen, laws: Laws, final: Calibration) -> Standing:
        """Names as they are judged: beside errors like what the fit leaves."""
        final = with_model_form(final)
        linear = as_fitted(linear, found.order, self.seen, final)
        laws = {e: own for e, own in laws.items() if e in found.order}
        return Standing(_beside_errors(linear, self.seen, final), found, laws, final)

    def settled(self, now: Standing) -> Standing:
        """Names changed until they stand: by a likelier set of no more, or without the weakest."""
        tried = {frozenset(now.found.order)}
        asked = False
        while True:
            other = None if asked else now.posterior.likelier(now.found, tried)
            if other is not None:
                tried.add(frozenset(other.order))
                again = self._instead(now, other)
                now, asked = again or now, again is None
            elif lost := with_one_less(now.posterior, now.found, now.final):
                tried.add(frozenset(lost.order))
                fitted = self.exactly(now.linear, lost)
                now, asked = self.standing(now.linear, lost, now.laws, fitted), False
            else:
                return now

    def _instead(self, now: Standing, other: Chosen) -> Standing | None:
        """Another set in the place of what stands; None: fitted exactly it says less."""
        laws = laws_at(now.linear, other.order, self.seen)
        linear = by_best_laws(now.linear, other.order, laws)
        try:
            again = self.exactly(linear, other)
        except (InputError, Refusal):  # it only seemed likelier
            return None
        if less_likely(again, now.final):
            return None
        return self.standing(linear, other, laws, again)


def less_likely(again: Calibration, before: Calibration, by: float = 0.0) -> bool:
    """Does a set that was chosen anew say less of the readings by so much of BIC?"""
    numbers = len(before.residual)
    gain = numbers * np.log(left(before) ** 2 / left(again) ** 2)
    if before.problem.common or again.problem.common:
        gain = 2.0 * (again.log_likelihood - before.log_likelihood)
    price = (len(again.x) - len(before.x)) * np.log(numbers)
    return bool(gain - price < -by)


def left(found: Calibration) -> float:
    """Rms of what a calibration leaves."""
    return rms(found.problem.of_channels.undo(found.residual))


def picked(linear: Linear, found: Chosen) -> list[Effect]:
    """The chosen effects."""
    return [linear.candidates[e] for e in found.order]


def _beside_errors(linear: Linear, seen: Calibration, final: Calibration) -> Linear:
    """The linear problem as names are judged by it: beside errors like what the fit leaves."""
    if final.form is None:
        return replace(linear, independent=None, errors=None)
    before, after = seen.problem, final.problem
    same = np.array_equal(before.measurements.joints, after.measurements.joints)
    if same and np.array_equal(before.rows, after.rows):  # in units of the noise beside the names
        there = linear.whitened(before.of_channels, after.of_channels)
        errors = beside_any(there, after, final.form)
    else:  # other rows are wild beside the names
        ratio = float(np.median(after.of_channels.sigma) / np.median(before.of_channels.sigma))
        errors = beside_any(linear, before, final.form.in_units(ratio))
    return replace(linear, independent=final.form.independent, errors=errors)
