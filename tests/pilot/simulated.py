"""Campaigns with a hidden cause: how many readings until the right name, by who chooses them.

The truth is the exact nonlinear model with springs of its own, not the pilot's linear map. All
policies are judged by the same rule to stop; they differ in which reading comes next alone.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sk120stiff.effects import LoadCases, effect
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.noise_statement import NoiseStatement
from sk120stiff.model import Model, typical_model
from sk120stiff.model import base_model as springs_of
from sk120stiff.pilot.campaign import Campaign, Stop
from sk120stiff.pilot.confirming import confirmed
from sk120stiff.plan import Cell, feasible_pool
from sk120stiff.plan.design import best_choice, determinant_worth
from sk120stiff.plan.planned import to_be_taken
from sk120stiff.robot import load_robot

SIGMA = 1e-5  # m
ARMS = {  # robot → measured point [m], force [N]
    "motoman_sk120": (np.array([-0.06, 0.04, 0.15]), 400.0),
    "ur5e": (np.array([0.05, 0.03, 0.10]), 80.0),
}
CAUSES = (
    "none", "joint_tilt", "link_bending", "link_torsion", "base_rocking", "base_sliding",
    "tool_compliance", "closure_rod", "lost_motion", "gear_hardening", "force_scale",
    "force_rotation", "joint_tilt", "link_bending",
)  # fmt: skip
OFF = 0.2  # of its logarithm by which each spring is off
SHOWN = (8.0, 30.0)  # √λ of the cause beyond the springs, over thirty random readings
MOST = 40
POLICIES = ("pilot", "random", "D-optimal")


@dataclass(frozen=True)
class Run:
    """One campaign of one policy: readings until it stopped, why, and whether that is right.

    Attributes:
        arm, truth, visible: What was hidden, and √λ of it over thirty random readings.
        policy: Who chose.
        count: Readings until the stop.
        reason, names: What was said.
        right: The truth is among the names, or rightly nothing.
        wrong: A name, or a class of them, that does not hold the truth.
        asked: How often the full judgement was asked before it agreed.
    """

    arm: str
    truth: str
    visible: float
    policy: str
    count: int
    reason: str
    names: tuple[str, ...]
    right: bool
    wrong: bool
    asked: int


class Remembering(Campaign):
    """The same campaign, which works out but once what its pool shows at the start."""

    @cached_property
    def known(self) -> dict[bytes, int]:
        """Row of the pool by pose and load."""
        pool = self.pool.load_cases
        return {_key(*both): k for k, both in enumerate(zip(pool.a, pool.wrench, strict=True))}

    @cached_property
    def at_start(self) -> tuple[np.ndarray, np.ndarray]:
        """Of all rows."""
        return super().rows(self.pool.load_cases, np.zeros(len(self.linear.scale)))

    def rows(self, load_cases: LoadCases, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """From memory where nothing has moved yet: no two readings here share a zero."""
        if v.any():
            return super().rows(load_cases, v)
        pairs = zip(load_cases.a, load_cases.wrench, strict=True)
        which = [self.known[_key(a, wrench)] for a, wrench in pairs]
        return self.at_start[0][which], self.at_start[1][which]


def _key(a: np.ndarray, wrench: np.ndarray) -> bytes:
    return np.round(np.concatenate([a, wrench]), 9).tobytes()


@dataclass(frozen=True, eq=False)
class Bench:
    """An arm with its pool, on which campaigns are simulated."""

    arm: str
    campaign: Campaign

    @classmethod
    def of(cls, arm: str, *, poses: int = 120, directions: int = 6) -> "Bench":
        robot = load_robot(arm)
        point, force = ARMS[arm]
        model = springs_of(robot) or typical_model(robot)
        pool = feasible_pool(
            robot, poses=poses, directions=directions, force=force, point=point, cell=Cell(), seed=1
        )
        return cls(arm, Remembering.of(model, pool, SIGMA, most=MOST))

    def truth(self, cause: str, rng: np.random.Generator) -> tuple[Model, str, float]:
        """Springs of its own, and a cause somewhere with a size that shows."""
        linear, X, base = self.campaign.linear, self.campaign.X, self.campaign.model
        off = np.exp(OFF * rng.normal(size=len(base.values)))
        model = base.with_values(base.values * off)
        places = [e for e in linear.effects if e.name == cause]
        if not places:
            return model, "none", 0.0
        chosen = places[rng.integers(len(places))]
        own = linear.columns[linear.effects.index(chosen)]
        size = np.exp(0.3 * rng.normal(size=len(own)))
        size *= np.where(linear.positive[own], 1.0, rng.choice([-1.0, 1.0], len(own)))
        rows = X[rng.choice(len(X), 30, replace=False)].reshape(90, -1)
        B = rows[:, linear.base]
        signature = rows[:, own] @ size
        left = np.linalg.norm(signature - B @ np.linalg.lstsq(B, signature, rcond=None)[0])
        wanted = rng.uniform(*SHOWN)
        size = size * wanted / max(left, 1e-9)
        full = model + effect(model.robot, chosen.name, chosen.where)
        values = full.values.copy()
        for k, p in enumerate(full.parameters):
            if p.effect.id == chosen.id:
                j = [q.name for q in linear.model.parameters].index(p.name)
                values[k] = size[list(own).index(j)] * linear.scale[j]
        plausible = [
            abs(v) <= p.spec.plausible
            for v, p in zip(values, full.parameters, strict=True)
            if p.effect.id == chosen.id
        ]
        if not all(plausible):  # too little of it shows on this arm: another cause is drawn
            return self.truth(CAUSES[rng.integers(1, len(CAUSES))], rng)
        return full.with_values(values), chosen.id, float(wanted)

    def read(self, exact: np.ndarray, noise: np.ndarray, rows: list[int]) -> Measurements:
        """Readings of some rows of the pool."""
        order = sorted(rows)
        plan = to_be_taken(self.campaign.model.robot, self.campaign.pool, order, zero="separate")
        return replace(
            plan,
            displacement=(exact + noise)[order],
            zero_group=np.arange(len(order)),
            zero_count=np.ones(len(order), dtype=np.int64),
            noise=NoiseStatement(SIGMA),
        )

    def order(self, policy: str, rng: np.random.Generator) -> list[int] | None:
        """The rows of a policy that is made beforehand; None: the pilot's."""
        X, linear = self.campaign.X, self.campaign.linear
        if policy == "pilot":
            return None
        if policy == "random":
            return [int(k) for k in rng.permutation(len(X))[:MOST]]
        columns, spread = linear.base, linear.spread[-1]
        if policy == "D-optimal for all":
            every = np.concatenate(linear.columns)
            columns = np.concatenate([columns, every])
            spread = np.concatenate([spread, np.ones(len(every))])
        A = X[:, :, columns] * spread
        gains = np.einsum("mik,mil->mkl", A, A)
        count = MOST if policy == "D-optimal" else MOST // 2
        interest = np.arange(len(columns), dtype=np.intp)
        rows = best_choice(determinant_worth(interest), gains, np.eye(len(columns)), count)
        rest = [int(k) for k in rng.permutation(len(X)) if k not in set(rows)]
        return [rows[k] for k in rng.permutation(len(rows))] + rest[: MOST - len(rows)]


def campaigns(bench: Bench, seed: int, *, ask: bool, policies=POLICIES) -> Iterator[Run]:
    """One hidden cause, measured by each of the policies."""
    rng = np.random.default_rng([seed, len(bench.arm)])
    cause = CAUSES[rng.integers(len(CAUSES))]
    model, name, visible = bench.truth(cause, rng)
    exact = model.predict(bench.campaign.pool.load_cases)
    noise = rng.normal(size=exact.shape) * SIGMA * np.sqrt(2.0)
    for policy in policies:
        order = bench.order(policy, np.random.default_rng([seed, 7]))

        def judge(readings: Measurements, stop: Stop) -> bool:
            return confirmed(bench.campaign.model, readings, stop).agrees

        count, stop, asked = _until(bench, exact, noise, order, judge if ask else None)
        names = {part for each in stop.names for part in each.split(" with ")}
        right = name in names if names else (stop.reason != "most" and name == "none")
        yield Run(
            bench.arm, name, visible, policy, count, stop.reason, stop.names, right,
            bool(names) and not right, asked,
        )  # fmt: skip


def _until(
    bench: Bench,
    exact: np.ndarray,
    noise: np.ndarray,
    order: list[int] | None,
    judge: Callable[[Measurements, Stop], bool] | None,
) -> tuple[int, Stop, int]:
    rows: list[int] = []
    readings, asked, wait = None, 0, 0
    while True:
        row = None if order is None or len(rows) >= MOST else order[len(rows)]
        if order is None:
            state = bench.campaign.state(readings)
            stop, row = state.stop, state.row
        else:
            stop = bench.campaign.judged(readings)[1]
        if stop is not None and stop.reason in ("named", "class") and judge is not None:
            if len(rows) < wait:
                stop = None
            elif len(rows) < MOST:
                asked += 1
                if not judge(readings, stop):  # type: ignore[arg-type]
                    stop, wait = None, len(rows) + 2
        if stop is not None:
            return len(rows), stop, asked
        if len(rows) >= MOST or row is None:
            return len(rows), Stop("most", (), ""), asked
        rows.append(row)
        readings = bench.read(exact, noise, rows)
