"""How the user steers the search: what may be missing, and what is taken for granted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from sk120stiff.effects import Effect, all_effects, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan import Cell

POSES_WITH_OFFSETS = 60  # beyond which offsets of single poses cost more than all else
MOST_EFFECTS = 8  # looked for unless the user says otherwise


@dataclass(frozen=True)
class Options:
    """How the user steers the search.

    Attributes:
        only, exclude: Effects (``name`` or ``name:where``) to which the search is limited, or which
            it leaves out.
        assume: Effects that are in the model from the start.
        max_effects: Largest number of named effects.
        alpha: Probability of naming something where nothing is missing, over all candidates
            together.
        prior: How probable effects are before anything is measured, by ``name`` or ``name:where``;
            the others are as probable as `priors.py` has them.
        seed: Of folds and resampling.
        cell: What poses to measure next must keep to; None: what the readings tell of it.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> answer = sk.explain(model, readings, options=sk.Options(only=("joint_tilt",)))
        >>> answer.limits
        ('Only these were looked for: joint_tilt.',)
    """

    only: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    assume: tuple[str, ...] = ()
    max_effects: int = MOST_EFFECTS
    alpha: float = 0.01
    prior: Mapping[str, float] = field(default_factory=dict)
    seed: int = 0
    cell: Cell | None = None

    @property
    def limits(self) -> tuple[str, ...]:
        """How this limits the search, in sentences."""
        said = []
        if self.only:
            said.append(f"Only these were looked for: {', '.join(self.only)}.")
        if self.exclude:
            said.append(f"These were not looked for: {', '.join(self.exclude)}.")
        if self.max_effects < MOST_EFFECTS:
            said.append(f"No more than {self.max_effects} effects were looked for.")
        return tuple(said)


def with_assumed(model: Model, used: Measurements, assumed: Sequence[str]) -> Model:
    """The model with the effects that the user takes for granted, to be fitted with it."""
    everything = _everything(model, used)
    load_cases = load_cases_of(model.robot, used)
    for wanted in assumed:
        found = [effect for effect in everything if _matches(effect, wanted)]
        if not found:
            raise _unknown(wanted, model)
        needed = ", or ".join(dict.fromkeys(e.needs for e in found if e.needs))
        found = [effect for effect in found if effect.applies_to(load_cases)]
        if not found:
            raise InputError(
                f"these readings do not hold what {wanted!r} needs",
                where=used.place,
                remedy=f"It needs {needed}." if needed else "See what its law takes.",
            )
        for effect in found:
            if effect.id not in {present.id for present in model.effects}:
                model = model + effect
    return model


def soft_joints(model: Model) -> set[str]:
    """Joints with a spring in the model: only there can gears change their stiffness."""
    springs = np.isfinite(model.joint_stiffness())
    return {joint for joint, yields in zip(model.robot.actuated, springs, strict=True) if yields}


def candidates_for(model: Model, used: Measurements, options: Options) -> tuple[Effect, ...]:
    """Effects of the catalogue that the readings could show and the user does not exclude.

    Offsets of single poses are looked for among at most `POSES_WITH_OFFSETS` poses, unless the
    user names them: beyond that they cost more time than all other effects together. Gears that
    change their stiffness are looked for, likewise, where the model has one: at a joint that it
    holds rigid the spring itself is missing first. Special cases are looked for where the user
    names them, or excludes the general effect.
    """
    load_cases = load_cases_of(model.robot, used)
    present = {effect.id for effect in model.effects}
    everything = _everything(model, used)
    refuse_unknown(everything, options, model)
    soft = soft_joints(model)
    excluded = {e.id for e in everything if any(_matches(e, w) for w in options.exclude)}
    general = {effect.id for effect in everything} - excluded

    def sensible(effect: Effect) -> bool:
        few = not effect.random_effects or len(used.poses) <= POSES_WITH_OFFSETS
        own = effect.special_case_of(model.robot) not in general
        return few and own and (not effect.bends_a_spring or effect.where in soft)

    found = tuple(
        effect
        for effect in everything
        if effect.id not in present
        and effect.applies_to(load_cases)
        and (sensible(effect) or any(_matches(effect, wanted) for wanted in options.only))
        and not any(_matches(effect, wanted) for wanted in options.exclude)
        and (not options.only or any(_matches(effect, wanted) for wanted in options.only))
    )
    if not found:
        raise InputError(
            "no effect is left to look for",
            where="--only, --exclude, --assume",
            remedy="Name fewer, or other ones: these readings may not show what they need.",
        )
    return found


def refuse_unknown(everything: Sequence[Effect], options: Options, model: Model) -> None:
    """Refuse names of effects to look for, or to leave out, that do not exist.

    Raises:
        InputError: One of them is no effect, or not at that place.
    """
    for wanted in (*options.only, *options.exclude):
        if not any(_matches(effect, wanted) for effect in everything):
            raise _unknown(wanted, model)


def _matches(effect: Effect, wanted: str) -> bool:
    return wanted in (effect.name, effect.id)


def _everything(model: Model, used: Measurements) -> tuple[Effect, ...]:
    """Every effect of the catalogue wherever it can act."""
    timed = used.time is not None
    return all_effects(model.robot, poses=used.poses, timed=timed, catalogue=model.catalogue)


def _unknown(wanted: str, model: Model) -> InputError:
    name, _, where = wanted.partition(":")
    if name in model.catalogue:
        return model.catalogue.misplaced(name, where, model.robot)
    return model.catalogue.unknown(wanted)
