"""The state of a campaign after some readings: what is known, what comes next, or why to stop.

Everything follows from the readings alone: a campaign can be left and taken up at any time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.data_checks import without_copies
from sk120stiff.effects import LoadCases, load_cases_of
from sk120stiff.errors import two_digits
from sk120stiff.explain.candidates.sums import sums_of
from sk120stiff.identify import Problem
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import Model
from sk120stiff.pilot.belief import Belief, Hypothesis
from sk120stiff.pilot.choosing import best, expected, separation
from sk120stiff.pilot.linear import LinearMap
from sk120stiff.plan import Pool
from sk120stiff.plan.design import DISPLACEMENT

SURE = 0.95  # probability from which on a name, or that nothing is missing, stands
OPEN = 0.05  # probability from which on another name counts, against a sure one or beside it
SPARE = 3  # numbers read beyond the parameters of a name: else no misfit could speak against it
APART = 3.3  # √λ at which two names are told apart
LITTLE = 0.01  # nat: a reading that brings less about names tells next to nothing
QUIET, ENOUGH = 0.7, 12  # probability of nothing, and readings, from which silence counts
LITTLE_LEFT = 0.5  # of a spring's variance beforehand: with more the readings say nothing of it
ROUNDS = 2  # of putting the linearisation where the readings are

Reason = Literal["named", "class", "none", "target", "hopeless", "most"]


@dataclass(frozen=True)
class Stop:
    """Why the campaign may end.

    Attributes:
        reason: ``named``: a name is sure; ``class``: one of several is, which no reading of this
            rig separates; ``none``: nothing is missing; ``target``: the springs are known well
            enough; ``hopeless``: no reading would tell more; ``most``: enough is enough.
        names: The names that are meant.
        sentence: The same in words, with what would help.
    """

    reason: Reason
    names: tuple[str, ...]
    sentence: str


@dataclass(frozen=True, eq=False)
class State:
    """What is known after some readings.

    Attributes:
        count: Number of readings.
        belief: Probabilities of the names.
        springs: Name, value, standard error and unit of the base model's parameters, as people
            write them; infinite where the readings say next to nothing.
        row: The pool's reading to take next; None where there is nothing to take.
        decides: What that reading would decide, in words.
        stop: Why to stop, or None.
    """

    count: int
    belief: Belief
    springs: tuple[tuple[str, float, float, str], ...]
    row: int | None
    decides: str
    stop: Stop | None


@dataclass(frozen=True, eq=False)
class Campaign:
    """What does not change from reading to reading.

    Attributes:
        model: Base model.
        pool: Readings that can be taken.
        sigma: Standard uncertainty of one reading per axis [m].
        linear, X: The linear map, and its columns at the pool in units of the noise (M, 3, P).
        target: Relative standard error of every spring at which enough is known; None: go on until
            a name is sure.
        most: Readings after which to stop in any case.
    """

    model: Model
    pool: Pool
    sigma: float
    linear: LinearMap
    X: Array
    target: float | None = None
    most: int = 60

    @classmethod
    def of(
        cls,
        model: Model,
        pool: Pool,
        sigma: float,
        *,
        target: float | None = None,
        most: int = 60,
    ) -> Campaign:
        """A campaign with a base model and the readings that can be taken."""
        linear, X = LinearMap.of(model, pool.load_cases, sigma * DISPLACEMENT)
        return cls(model, pool, sigma, linear, X, target, most)

    def belief(self, readings: Measurements | None) -> Belief:
        """What readings say, the linearisation put where the most probable hypothesis is.

        Two rounds bring other names to what their exact laws say, most within a tenth of a nat.
        """
        linear = self.linear
        size = len(linear.scale)
        found = Belief(linear, sums_of(np.zeros((0, size)), np.zeros(0)))
        if readings is None:
            return found
        used = without_copies(readings)[0].masked()
        zero: Literal["shared", "separate"] = "shared" if used.zero == "shared" else "separate"
        problem = Problem(self.model, used, NoiseModel(self.sigma, zero=zero))
        base = linear.model.values / linear.scale
        least = np.where(linear.positive, 0.0, -np.inf)
        v = np.zeros(size)
        for _ in range(ROUNDS):
            predicted, derivative = self.rows(problem.load_cases, v)
            X = problem.whitener.apply(derivative)
            y = problem.whitener.apply(problem.measured - predicted) + X @ v
            found = Belief(linear, sums_of(X, y))
            leader = found.leader
            v = np.zeros(size)
            v[leader.columns] = leader.mean
            v = np.maximum(base + v, np.where(base > 0.0, 0.2 * base, least)) - base
        return found

    def rows(self, load_cases: LoadCases, v: Array) -> tuple[Array, Array]:
        """(N, 3) predictions and (N, 3, P) changes per typical size [m], v of these off the start.

        Args:
            v: (P,) typical sizes.
        """
        linear = self.linear
        at = linear.model.with_values(linear.model.values + v * linear.scale)
        predicted, derivative = at.predict_with_sensitivities(load_cases)
        return predicted, derivative * linear.scale

    def state(self, readings: Measurements | None) -> State:
        """What is known, what comes next, or why to stop."""
        belief, stop = self.judged(readings)
        taken = self._taken(readings)
        row = best(belief, self.X, ~taken)
        decides, springs = self._decides(belief, row), self._springs(belief)
        count = _count(readings)
        return State(count, belief, springs, None if taken.all() else row, decides, stop)

    def judged(self, readings: Measurements | None) -> tuple[Belief, Stop | None]:
        """What is known, and why to stop."""
        belief = self.belief(readings)
        return belief, self._stop(belief, readings)

    def load_cases(self, row: int) -> LoadCases:
        """A reading of the pool."""
        return self.pool.load_cases.rows(np.array([row], dtype=np.intp))

    def _taken(self, readings: Measurements | None) -> Mask:
        """Readings of the pool that were taken already."""
        pool = self.pool.load_cases
        taken = np.zeros(pool.count, dtype=bool)
        if readings is None:
            return taken
        done = load_cases_of(self.model.robot, readings)
        for a, wrench in zip(done.a, done.wrench, strict=True):
            near = np.abs(pool.a - a).max(axis=1) < 1e-4
            load = np.linalg.norm(pool.wrench - wrench, axis=1)
            taken |= near & (load < 0.02 * np.linalg.norm(wrench))
        return taken

    def _springs(self, belief: Belief) -> tuple[tuple[str, float, float, str], ...]:
        linear, leader = belief.linear, belief.leader
        errors = belief.spring_errors()
        errors = np.where(errors**2 < LITTLE_LEFT * linear.spread[0] ** 2, errors, np.inf)
        out = []
        for k, column in enumerate(linear.base):
            p = linear.model.parameters[column]
            value = p.internal + float(leader.mean[k]) * linear.scale[column]
            std = float(errors[k]) * linear.scale[column]
            if p.spec.lower == 0.0:
                value = max(value, 1e-3 * p.internal)
            out.append((p.name, p.spec.public(value), p.spec.public_std(value, std), p.spec.unit))
        return tuple(out)

    def _decides(self, belief: Belief, row: int) -> str:
        rows = [h for w, h in zip(belief.weights, belief.hypotheses, strict=True) if w > 0.02][:2]
        one = self.X[row : row + 1]
        about = expected(belief, one)
        names, sizes = (float(x[0]) / np.log(2.0) for x in (about.names, about.sizes))
        if len(rows) == 2 and float(about.names[0]) > LITTLE:
            first, second = (_said(belief, h.members) for h in rows)
            return (
                f"whether it is {first} or {second} ({names:.2f} bit about names, {sizes:.2f} bit "
                "about sizes)"
            )
        return f"sizes ({sizes:.2f} bit), names hardly ({names:.3f} bit)"

    def _stop(self, belief: Belief, readings: Measurements | None) -> Stop | None:
        count = _count(readings)
        left = max(self.most - count, 1)
        if not belief.linear.effects and not self._within_reach(belief, left):
            return Stop("hopeless", (), self._blind())
        if belief.sums.count - len(belief.leader.columns) < SPARE:
            return None
        if belief.unexplained:
            return None if count < self.most else self._enough(count)
        probabilities = belief.probabilities
        sure = tuple(n for n, p in probabilities.items() if p >= SURE and n != "none")
        open_ = [n for n, p in probabilities.items() if OPEN < p < SURE and n != "none"]
        if sure and not open_:
            return Stop("named", sure, f"{' and '.join(sure)}: P = {probabilities[sure[-1]]:.3f}.")
        alike = self._inseparable(belief, left)
        if len(alike) > 1:
            names_ = tuple(_said(belief, h.members) for h in alike)
            return Stop(
                "class", names_,
                f"hopeless: no reading of this rig separates {' from '.join(names_)}; "
                f"{_help(belief, alike)} would.",
            )  # fmt: skip
        if probabilities["none"] >= SURE and belief.linear.effects:
            return Stop(
                "none", (),
                f"Nothing is missing that these readings could show.{self._open_words(belief)}",
            )  # fmt: skip
        if self.target is not None and not self._open(belief):
            return Stop("target", (), f"Every spring is known to {100 * self.target:g} %.")
        if count >= ENOUGH and belief.linear.effects:
            names = expected(belief, self.X[~self._taken(readings)]).names
            if probabilities["none"] >= QUIET and float(names.max(initial=0.0)) < LITTLE:
                return Stop(
                    "none", (),
                    "Nothing missing shows, and no reading of this rig is expected to tell more "
                    f"about that.{self._open_words(belief)}",
                )  # fmt: skip
            if float(np.sort(names)[-left:].sum()) < LITTLE:
                return Stop("hopeless", (), "No reading of this rig would tell more about names.")
        return None if count < self.most else self._enough(count)

    def _open(self, belief: Belief) -> list[tuple[str, float]]:
        """Springs that are not known to the target, and how well they are."""
        shares = [(name, std / abs(value)) for name, value, std, _ in self._springs(belief)]
        return [] if self.target is None else [each for each in shares if each[1] > self.target]

    def _open_words(self, belief: Belief) -> str:
        """What is said of them beside a stop that is not for their sake."""
        found = self._open(belief)
        if not found or self.target is None:
            return ""
        names = ", ".join(
            f"{name} ({f'{two_digits(100 * share)} %' if share < 1.0 else 'unknown'})"
            for name, share in found
        )
        return f" Not known to {100 * self.target:g} % yet: {names}; next.csv goes on for those."

    def _within_reach(self, belief: Belief, left: int) -> bool:
        """Could so many readings, each the best of all for it, bring every spring to the target?"""
        if self.target is None:
            return False
        base = belief.linear.base
        most = left * (self.X[:, :, base] ** 2).sum(axis=1).max(axis=0)
        least = 1.0 / np.sqrt(belief.spring_errors() ** -2.0 + most)
        parameters = [belief.linear.model.parameters[column] for column in base]
        size = np.abs([p.internal for p in parameters]) / belief.linear.scale[base]
        return bool((least <= self.target * size).all())

    def _blind(self) -> str:
        """Why it is hopeless where no effect of the catalogue could show."""
        return (
            "Of its usual size no effect of the catalogue moves the point by half the noise of a "
            f"reading ({1e3 * self.sigma:.3g} mm) at any pose and load of this rig: nothing that "
            "is missing would show"
            + (", nor would all springs come to the target" if self.target is not None else "")
            + ". Larger loads (--force) would help, or an instrument with less noise."
        )

    def _enough(self, count: int) -> Stop:
        return Stop("most", (), f"{count} readings were the most that were asked for.")

    def _inseparable(self, belief: Belief, left: int) -> list[Hypothesis]:
        """Hypotheses that make up nearly everything and that no readings to come tell apart."""
        rows = [(w, h) for w, h in zip(belief.weights, belief.hypotheses, strict=True) if w > OPEN]
        if len(rows) < 2 or any(not h.members for _, h in rows):
            return []
        if sum(w for w, _ in rows) < SURE:
            return []
        leader = rows[0][1]
        for _, h in rows[1:]:
            both = max(
                separation(belief, leader, h, self.X, left),
                separation(belief, h, leader, self.X, left),
            )
            if both > APART:
                return []
        return [h for _, h in rows]


def _count(readings: Measurements | None) -> int:
    return 0 if readings is None else without_copies(readings)[0].masked().n_readings


def _said(belief: Belief, members: tuple[int, ...]) -> str:
    return " with ".join(belief.linear.effects[e].id for e in members) or "nothing"


def _help(belief: Belief, alike: list[Hypothesis]) -> str:
    """What kind of reading the rig lacks."""
    effects = [belief.linear.effects[e] for h in alike for e in h.members]
    if any("rotation" in p.name or "N*m" in p.unit for e in effects for p in e.parameters):
        return "a reading of the tool's rotation, or a moment,"
    return "another measured point, or another direction of load,"
