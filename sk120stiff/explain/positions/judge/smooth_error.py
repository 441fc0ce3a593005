"""Evidence for names beside an error of the model that nobody knows, and that is smooth.

What is left of real arms is mostly smooth over the joints: numbers err together there, and a name
may be the part of such an error that looks like it. So every set of names is judged beside errors
of any such kind and size (Kennedy & O'Hagan, J. R. Stat. Soc. B 63, 2001, p. 425): as large as what
is left has it, and larger in one joint or in all. Without a name the error has to be larger, which
costs the likelihood what a spread of possible errors costs. That is all that speaks for the name.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import linalg
from scipy.special import logsumexp

from sk120stiff.arrays import Array, Mask
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify.positions.noise.model_form import (
    ModelForm,
    cells_of,
    smooth_ways,
    some_rows,
)
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.robot import STANDARD_GRAVITY

LARGER = (0.25, 4.0, 64.0)  # times the variance of what is left, that an error has beside it
KEPT = 6  # errors that every other set is judged beside, of those likeliest for the chosen one
ALIKE = 1e-9  # share of the largest load by which loads differ that are one


@dataclass(frozen=True, eq=False)
class SmoothError:
    """Positions to first order, in units of one possible error after the other.

    Attributes:
        each: Of every error the problem, of which its base takes part, and logarithms of its size.
        at: Those of them that count.
        known: What was scored before, by error and set.
    """

    each: tuple[tuple[Linear, float], ...]
    at: tuple[int, ...]
    known: dict[tuple[int, frozenset[int]], float] = field(default_factory=dict)

    def score(self, chosen: tuple[int, ...]) -> float:
        """Logarithm of the evidence, over all errors alike, up to a constant of all models."""
        scores = [self._one(k, chosen) for k in self.at]
        return float(logsumexp(scores) - np.log(len(scores)))

    def joined(self, chosen: tuple[int, ...]) -> tuple[Array, Mask]:
        """(K,) the same with one more candidate each, and which are exact; see `Linear.joined`."""
        scores, exact = list[Array](), list[Mask]()
        for problem, volume in (self.each[k] for k in self.at):
            score, own = problem.joined(chosen, 1.0)
            scores.append(score - volume)
            exact.append(own)
        return logsumexp(scores, axis=0) - np.log(len(scores)), np.all(exact, axis=0)

    def likeliest(self, sets: Sequence[tuple[int, ...]]) -> SmoothError:
        """The errors alone that are likeliest beside any of these sets."""
        kept = set[int]()
        for chosen in sets:
            ranked = sorted(self.at, key=lambda k: self._one(k, chosen), reverse=True)
            kept |= set(ranked[:KEPT])
        return replace(self, at=tuple(sorted(kept)))

    def _one(self, k: int, chosen: tuple[int, ...]) -> float:
        key = k, frozenset(chosen)
        if key not in self.known:
            problem, volume = self.each[k]
            self.known[key] = problem.score(chosen, 1.0) - volume
        return self.known[key]


def of_errors(linear: Linear, covariances: Iterable[Array]) -> SmoothError:
    """The linear problem of M numbers beside errors of these covariances (M, M)."""
    each = tuple(in_units_of(linear, V) for V in covariances)
    return SmoothError(each, tuple(range(len(each))))


def beside_any(linear: Linear, problem: PoseProblem, form: ModelForm) -> SmoothError:
    """The linear problem beside what errors of the model may be.

    Args:
        linear: It, in units of the noise of `problem`.
        problem: The readings, as they were fitted beside the chosen names.
        form: What is left beside the chosen names.
    """
    rows = some_rows(problem)
    part = np.isin(linear.row, rows)
    here = replace(problem, measurements=problem.measurements.select(rows))
    U, told, _ = np.linalg.svd(linear.base[part], full_matrices=False)
    some = replace(  # of a station that is not among these rows the base tells nothing here
        linear, base=U[:, told > 1e-9 * told.max(initial=1e-300)], residual=linear.residual[part],
        row=linear.row[part], columns=linear.columns[part], errors=None,
    )  # fmt: skip
    return of_errors(some, _covariances(here, form))


def in_units_of(linear: Linear, V: Array) -> tuple[Linear, float]:
    """The linear problem of M numbers as it is where these err as V (M, M) has it.

    And the logarithm of the size of V beside the base (the restricted likelihood, Harville 1974).
    """
    P = linear.base.shape[1]
    L = linalg.cholesky(V, lower=True)
    white = np.column_stack([linear.base, linear.residual, linear.columns])
    white = linalg.solve_triangular(L, white, lower=True)
    Q, R = np.linalg.qr(white[:, :P])
    rest = white[:, P:] - Q @ (Q.T @ white[:, P:])
    volume = np.log(np.diag(L)).sum() + np.log(np.abs(np.diag(R))).sum()
    there = replace(
        linear, base=Q, residual=rest[:, 0], columns=rest[:, 1:], stated=True, independent=None,
        fold=np.zeros(len(rest), dtype=np.intp),
    )  # fmt: skip
    return there, float(volume)


def _covariances(problem: PoseProblem, form: ModelForm) -> Iterator[Array]:
    """(M, M) of noise and of what errors may be beside it, one after the other."""
    ways = list(smooth_ways(problem))
    cell = cells_of(problem)
    own = [way @ way.T for way in ways]
    together = np.equal.outer(cell, cell).astype(float)
    left = sum((size * each for size, each in zip(form.sizes, [*own, together], strict=True)), 0.0)
    usual = float(np.trace(left)) / len(cell)
    found = form.noise * np.eye(len(cell)) + left
    yield found
    for times in LARGER:
        yield found + times * left
    kinds, load = [own], _loads(problem)
    if load is not None:  # a law of what yields goes with the load
        kinds.append([way @ way.T for way in (load[:, None] * each for each in ways)])
    for kind in kinds:
        alike = [each * len(cell) / size for each in kind if (size := float(np.trace(each))) > 0.0]
        for each in (*alike, sum(alike, 0.0) / max(len(alike), 1)):
            for times in LARGER:
                yield found + times * usual * each
    for times in LARGER:
        yield found + times * usual * together


def _loads(problem: PoseProblem) -> Array | None:
    """(M,) load of each number against the mean of all, of the largest; None: all alike."""
    force = np.linalg.norm(problem.measurements.wrench[:, :3], axis=1)
    load = STANDARD_GRAVITY * np.abs(problem.said.payload) + force
    beyond = (load - load.mean())[problem.rows]
    most = float(np.abs(beyond).max(initial=0.0))
    return None if most <= ALIKE * float(load.max(initial=0.0)) else beyond / most
