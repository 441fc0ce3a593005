"""Measurements made from a model: what a tracker would read, noise included."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import LoadCases, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.files import html_table
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.measurements.noise_statement import Instrument, NoiseStatement
from sk120stiff.model import Model
from sk120stiff.plan.schedule import Schedule, scheduled
from sk120stiff.plan.simulated_channels import simulated_channels

OUTLIER = (5.0, 20.0)  # least and largest size of an outlier, over the noise of its reading


@dataclass(frozen=True, eq=False)
class Simulated:
    """Simulated readings and what lies under them.

    Attributes:
        measurements: The readings with noise: displacements, or channels as the plan has them.
        exact: (N, 3) displacements without noise [m].
        zero_error: (N, 3) error of the zero reading that each row subtracts [m]; equal within a
            zero group.
        outliers: (N,) readings that were made outliers.
    """

    measurements: Measurements
    exact: Array
    zero_error: Array
    outliers: Mask

    def __repr__(self) -> str:
        return f"<Simulated: {self.measurements!r}, {int(self.outliers.sum())} outliers>"

    def _repr_html_(self) -> str:
        """What a notebook shows: every reading with noise and without."""
        if self.measurements.displacement is None:
            return self.measurements._repr_html_() or repr(self)
        made, exact = (1e6 * np.asarray(x) for x in (self.measurements.displacement, self.exact))
        columns: dict[str, Iterable[object]] = {"pose": self.measurements.pose}
        columns |= {f"d{axis} [µm]": made[:, k] for k, axis in enumerate("xyz")}
        columns |= {f"exact d{axis}": exact[:, k] for k, axis in enumerate("xyz")}
        return html_table(repr(self), columns)


def simulate(
    model: Model,
    plan: Measurements,
    *,
    noise: NoiseModel | Instrument | None = None,
    rotation_noise: float | None = None,
    schedule: Schedule | None = None,
    outliers: float = 0.0,
    seed: int = 0,
) -> Simulated:
    """Readings that a modelled arm would give.

    A loaded reading and a zero reading are drawn each by itself, by the law of
    `measurements.noise`; a displacement is their difference. Of a plan of positions, single
    readings or turns the rows come back as they are, each cell with a reading of its own.

    Args:
        model: The truth, at exact equilibrium.
        plan: Poses and loads; displacements in it are not looked at.
        noise: What one reading is worth; None: readings without noise. Rows that state their own
            uncertainty (sx, sy, sz) are drawn with that. Whether zero readings are shared says the
            schedule. An instrument is sharp along its ray and duller across it.
        rotation_noise: Standard uncertainty of one angle that is read [rad], of plans that hold
            angles; None: as the plan states it, else none.
        schedule: Load steps, repeats and zero readings; by default every row as given, zeros
            shared.
        outliers: Share of the loaded readings that are off by 5 to 20 times their noise in a random
            direction.
        seed: Of the draw.

    Raises:
        InputError: A plan without loads, a share that is none, an instrument for displacements in
            axes of the tool, or what has no meaning for positions (a schedule, growing noise).
        Refusal: The springs cannot hold a load.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> made = sk.simulate(model, sk.plan(model, 6, point=[-0.06, 0.04, 0.15]))
        >>> made.measurements.displacement.shape
        (6, 3)
    """
    if not 0.0 <= outliers < 1.0:
        raise InputError(f"{outliers:g} is no share of outliers", remedy="Give 0 to 1, as 0.05.")
    if outliers and noise is None:
        raise InputError(
            "outliers are measured in units of the noise, and there is none",
            remedy="Give a noise, e.g. --noise '10 um'.",
        )
    if plan.absolute is not None:
        return _of_channels(model, plan, noise, rotation_noise, schedule, outliers, seed)
    if rotation_noise is not None:
        raise InputError(
            "no angle is read in this plan",
            where=str(plan.path or "plan"),
            remedy="Leave the noise of rotations out.",
        )
    steps = schedule or Schedule()
    readings = scheduled(plan, steps)
    cases = load_cases_of(model.robot, readings)
    exact = model.predict(cases)
    count = readings.n_readings
    error, zero_error = np.zeros((count, 3)), np.zeros((count, 3))
    hit = np.zeros(count, dtype=bool)
    if noise is not None:
        rng = np.random.default_rng(seed)
        group = readings.zero_group
        zero_draws = rng.normal(size=(int(group.max()) + 1, 3))[group]
        draws = rng.normal(size=(count, 3))
        if isinstance(noise, Instrument):
            own, zero_error, error = _seen(noise, model, readings, zero_draws, draws)
        else:
            of_readings = replace(noise, force=0.0)
            own, zero = of_readings.variances(readings, np.linalg.norm(exact, axis=1))
            zero_error, error = zero_draws * np.sqrt(zero), draws * np.sqrt(own)
        hit = rng.random(count) < outliers
        direction = rng.normal(size=(count, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        size = rng.uniform(*OUTLIER, count) * np.sqrt(own.mean(axis=1))
        error += (hit * size)[:, None] * direction
        if isinstance(noise, NoiseModel) and noise.force > 0.0:
            error += _by_forces(model, cases, noise.force, rng) - exact
    stated = NoiseStatement()
    if isinstance(noise, Instrument):
        stated = NoiseStatement(instrument=noise)
    elif noise is not None:
        stated = NoiseStatement(noise.sigma, noise.growth or None, force=noise.force or None)
    made = replace(
        readings,
        displacement=exact + error - zero_error,
        noise=stated,
        path=None,
        source=f"simulated from a model of {model.robot.name}, seed {seed}",
        data_hash="",
        notes=(),
    )
    return Simulated(made, exact, zero_error, hit)


def _of_channels(
    model: Model,
    plan: Measurements,
    noise: NoiseModel | Instrument | None,
    rotation_noise: float | None,
    schedule: Schedule | None,
    outliers: float,
    seed: int,
) -> Simulated:
    """See `simulate`: of positions, single readings and turns."""
    growing = isinstance(noise, Instrument) or (
        noise is not None and noise.growth + noise.force > 0.0
    )
    if growing or (schedule is not None and schedule != Schedule(zero=schedule.zero)):
        raise InputError(
            "load steps, repeats, growing noise, errors of forces and a ray are those of "
            "displacements, and this plan is read row by row",
            where=str(plan.path or "plan"),
            remedy="Leave them out: write every row that is to be read into the plan.",
        )
    said = plan.absolute
    stated = 0.0 if said is None else said.channels.sigma.get("rotation", 0.0)
    rng = np.random.default_rng(seed)
    hit: Mask = rng.random(plan.n_readings) < outliers
    made = simulated_channels(
        model,
        plan.with_joints(model.robot.actuated, model.robot.kinds),
        length=noise.sigma if isinstance(noise, NoiseModel) else 0.0,
        angle=stated if rotation_noise is None else rotation_noise,
        own_zero=schedule is not None and schedule.zero == "separate",
        off=hit,
        size=rng.uniform(*OUTLIER, plan.n_readings),
        rng=rng,
    )
    source = f"simulated from a model of {model.robot.name}, seed {seed}"
    exact = model.under(plan.gravity).predict(load_cases_of(model.robot, made))
    return Simulated(replace(made, source=source), exact, np.zeros_like(exact), hit)


def _by_forces(model: Model, cases: LoadCases, share: float, rng: np.random.Generator) -> Array:
    """(N, 3) displacements under forces each component of which is off by a share of them [m]."""
    size = np.linalg.norm(cases.wrench[:, :3], axis=1, keepdims=True)
    wrench = cases.wrench.copy()
    wrench[:, :3] += share * size * rng.normal(size=(cases.count, 3))
    return model.predict(replace(cases, wrench=wrench))


def _seen(
    instrument: Instrument, model: Model, readings: Measurements, zero_draws: Array, draws: Array
) -> tuple[Array, Array, Array]:
    """Variances along the axes (N, 3), and the errors of zero and loaded readings (N, 3).

    Args:
        zero_draws, draws: (N, 3) standard normal numbers.
    """
    if readings.displacement_frame != "base":
        raise InputError(
            "an instrument has its rays in axes of the base, the plan says 'tool'",
            where=str(readings.path or "plan"),
            remedy="Write 'displacement: {frame: base}' into the YAML file.",
        )
    points = model.robot.screws(readings.joints, point=readings.point).position
    rays, along, across = instrument.at(points)
    sharper = (along - across)[:, None]

    def errors(normal: Array) -> Array:
        onto = (rays * normal).sum(axis=1, keepdims=True)
        return np.asarray(across[:, None] * normal + sharper * onto * rays)

    own = across[:, None] ** 2 + (along**2 - across**2)[:, None] * rays**2
    return own, errors(zero_draws), errors(draws)


def as_positions(model: Model, simulated: Simulated) -> Measurements:
    """The same readings as positions of the point in the base frame, with their zero rows.

    `displacement` of what is returned holds positions [m], for `write_measurements` with
    ``as_positions=True``. The unloaded arm stands where the rigid robot says.

    Raises:
        InputError: The plan asks for displacements in the axes of the tool.
    """
    readings = simulated.measurements
    if readings.displacement_frame != "base" or readings.displacement is None:
        raise InputError(
            "positions are given in axes of the base frame, the plan says 'tool'",
            where=str(readings.path or "plan"),
            remedy="Write 'displacement: {frame: base}' into the YAML file.",
        )
    start = model.robot.screws(readings.joints, point=readings.point).position
    _, first = np.unique(readings.zero_group, return_index=True)
    rows = np.concatenate([first, np.arange(readings.n_readings)])
    is_zero = np.arange(len(rows)) < len(first)
    order = np.where(is_zero, _known(readings.zero_order)[rows], _known(readings.order)[rows])
    zero = start + simulated.zero_error
    position = np.where(is_zero[:, None], zero[rows], (zero + readings.displacement)[rows])
    wrench = np.where(is_zero[:, None], 0.0, readings.wrench[rows])
    sequence = np.argsort(order, kind="stable")
    picked = readings.select(rows[sequence])
    branch = picked.branch
    if branch is not None:
        branch = tuple("" if z else b for z, b in zip(is_zero[sequence], branch, strict=True))
    return replace(
        picked,
        wrench=wrench[sequence],
        displacement=position[sequence],
        order=order[sequence],
        branch=branch,
        zero_order=None,
    )


def _known(order: Array | None) -> Array:
    if order is None:
        raise ValueError("simulated readings always have an order")
    return order
