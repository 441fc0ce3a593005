"""Scale slips: everything yields so much more, or less, than such an arm could.

All springs together, the force's scale and the reading's scale are one number to such readings: no
fit can tell a soft arm from kilogram-force labelled N. What can be said is how far the springs that
follow lie from those the model brings, or from those usual for an arm of that size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.data_checks.passive import compliances, passive
from sk120stiff.effects import Effect, effect, load_cases_of
from sk120stiff.errors import listed
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, Parameter, joint_spring_model
from sk120stiff.model.typical import TYPICAL
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import WHOLE_ARM, arm_length

#: Softest and stiffest usual drive of a base joint, by the arm's stretched length. Orders of
#: magnitude: a gear winds up by one to a few mrad at its rated torque, and rated torque goes with
#: payload times reach. Measured: 4.0e5, 9.4e5, 1.4e6 on 2.9 m and 120 kg (the 2005 paper), 0.9e6 to
#: 2.7e6 on 2.9 m and 210 kg (public readings). Gears of industrial arms of 1 m, by catalogue: 1.7e5
#: (RV-20E, 49 N·m per arc minute). Wide, for light arms and industrial ones share
#: lengths, and only a doubt follows from it.
USUAL = (
    (0.5, 1e3, 2e4),  # payload 1 kg
    (1.0, 4e3, 2.5e5),  # 3 to 20 kg
    (1.5, 1.2e4, 4e5),  # 10 to 20 kg
    (2.0, 8e4, 1e6),  # 30 to 60 kg
    (2.9, 2.5e5, 3.5e6),  # 120 to 210 kg
    (4.0, 7e5, 1e7),  # 300 to 700 kg
)  # (m, N·m/rad, N·m/rad)
WRIST = 0.25  # a wrist drive's stiffness over that of a base joint
GUESSED = ("starting value", TYPICAL)  # origins of springs that nobody measured or stated
KNOWN = 3.0  # no arm is so many times softer or stiffer than the springs identified for it
CERTAIN = 200.0  # no arm is so much softer or stiffer than another; a unit is
BEYOND = 1.3  # times softer or stiffer than usual for its size, from where on it is told
BY_FAR = 2.0  # times the squares that springs must leave alone, for more to be needed
WELL = 0.01  # share of all squares that they leave where they explain readings by themselves
BROUGHT = ("base_rocking", "base_sliding", "tool_compliance")  # not of the arm's maker
NEARBY = 3.0  # times beyond what is told, up to which an arm may just be another than most
SOFTER, STIFFER = (f"an arm that is {than} than most of its size" for than in ("softer", "stiffer"))
MOST_UNITS = 6  # that are listed: a usual band spans two decades
ALIKE = 0.3  # share of the readings' squares that one factor must explain to say anything
UNITS = (
    (4.448, "forces in lbf labelled N", "forces in N labelled lbf"),
    (9.807, "forces in kgf labelled N", "forces in N labelled kgf"),
    (10.0, "displacements in mm labelled cm", "displacements in cm labelled mm"),
    (25.4, "displacements in mm labelled inch", "displacements in inch labelled mm"),
    (39.37, "displacements in um labelled thou of an inch", "displacements in inch labelled m"),
    (100.0, "displacements in mm labelled dm", "displacements in dm labelled mm"),
    (1000.0, "displacements in um labelled mm, or in mm labelled m; forces in kN labelled N",
     "displacements in mm labelled um, or in m labelled mm; forces in N labelled kN"),
    (1e6, "displacements in um labelled m", "displacements in m labelled um"),
)  # fmt: skip


def yields_times(
    model: Model, measurements: Measurements, apart: Sequence[int] = ()
) -> float | None:
    """How many times as much the arm yields as the model's springs let it.

    None where the readings do not look like such an arm at all, so that one factor says nothing.

    Args:
        model: Of its springs only the elastic parameters count.
        measurements: Readings.
        apart: Of these, those that yield as they like, and of which nothing is said.
    """
    used = measurements.masked()
    if used.displacement is None:
        return None
    each, d, _ = _elastic(model, used)
    together = [k for k in range(each.shape[1]) if k not in apart]
    A = np.column_stack([each[:, together].sum(axis=1), each[:, apart]])
    c = compliances(A.T @ A, A.T @ d)
    if c is None or c[0] <= 0.0:
        return None
    along = c * (A.T @ d)  # what each explains of the readings' squares
    beside = float(d @ d - along[1:].sum())
    return float(c[0]) if along[0] > ALIKE * beside else None


@dataclass(frozen=True)
class Scale:
    """Everything yields too much or too little.

    Attributes:
        sentence: What was seen and what it may be.
        certain: By so much that only a unit can be wrong.
    """

    sentence: str
    certain: bool


def scale_doubt(model: Model, measurements: Measurements) -> Scale | None:
    """Are the springs that follow implausible for this arm, or for one of its size?"""
    robot = model.robot
    if any(p.spec.reciprocal and p.origin not in GUESSED for p in model.parameters):
        times = yields_times(model, measurements)
        if times is None or (times > KNOWN and _of_what_was_brought(model, measurements, KNOWN)):
            return None
        said = _times(times, "the model's springs let it (if they are of this arm)")
        return _doubt(said, times, 1.0 / KNOWN, KNOWN)
    length = arm_length(robot)
    rails = _rails(robot)
    if rails is None or not USUAL[0][0] <= length <= USUAL[-1][0]:
        return None
    softest, stiffest = usual_stiffness(length)
    middle = float(np.sqrt(softest * stiffest))
    base = np.where(np.arange(robot.n) < 3 + len(rails), middle, WRIST * middle)
    usual, most = joint_spring_model(robot, base), middle / softest * BEYOND
    times = yields_times(usual, measurements, rails)
    if times is None or (times > most and _of_what_was_brought(usual, measurements, most)):
        return None
    said = (
        f"the springs of {listed(robot.actuated[: 3 + len(rails)])} come out at about "
        f"{middle / times:.2g} N*m/rad, "
        f"usual on an arm of {length:.2g} m are {softest:.2g} to {stiffest:.2g}"
    )
    return _doubt(said, times, middle / stiffest / BEYOND, most)


def _of_what_was_brought(model: Model, measurements: Measurements, most: float) -> bool:
    """Do foundation and tool yield so much, with half of the springs no softer than `most` times?

    What stands on wheels, or carries a tool on rubber, may be softer there than all its drives. A
    unit that is wrong makes all of them look soft alike.
    """
    there, names = ({getattr(e, what) for e in model.effects} for what in ("id", "name"))
    more = [effect(model.robot, name) for name in BROUGHT if name not in names]
    if not more:
        return False
    beside = model + [
        Parameter(each, spec, spec.usual) for each in more for spec in each.parameters
    ]
    A, d, of = _elastic(beside, measurements.masked())
    springs_alone = 1.0 - passive(A[:, [each.id in there for each in of]], d).share
    c = compliances(A.T @ A, A.T @ d)
    if c is None or springs_alone < max(BY_FAR * (1.0 - passive(A, d).share), WELL):
        return False
    springs = c[[each.joint_spring for each in of]]
    moving = springs[springs > 0.0]
    return bool(len(moving)) and bool(np.median(moving) < most)


def _elastic(model: Model, used: Measurements) -> tuple[Array, Array, list[Effect]]:
    """(3 N, k) what the elastic parameters do to what was read (3 N,), and their effects."""
    elastic = [k for k, p in enumerate(model.parameters) if p.spec.reciprocal]
    load_cases = load_cases_of(model.robot, used)
    _, S = model.predict_with_sensitivities(load_cases, np.zeros(len(model.values)))
    each = np.where(used.read[:, :, None], S[:, :, elastic] * model.values[elastic], 0.0)
    return (
        each.reshape(-1, len(elastic)),
        used.moved.ravel(),
        [model.parameters[k].effect for k in elastic],
    )


def _rails(robot: Robot) -> list[int] | None:
    """The slides that carry a whole arm, before its first joint; None: others slide, too.

    What drives them is another matter: they yield as they like.
    """
    slides = np.flatnonzero(robot.prismatic).tolist()
    turning = robot.n - len(slides)
    rails = slides == list(range(len(slides))) and (not slides or turning >= WHOLE_ARM)
    return slides if rails else None


def usual_stiffness(length: float) -> tuple[float, float]:
    """Softest and stiffest usual base drive [N·m/rad] of an arm of that stretched length [m]."""
    sizes, *ends = np.log(np.array(USUAL)).T
    softest, stiffest = (float(np.exp(np.interp(np.log(length), sizes, end))) for end in ends)
    return softest, stiffest


def _times(times: float, whose: str) -> str:
    much = f"{times:.3g} times as much as" if times > 1.0 else f"1/{1.0 / times:.3g} of what"
    return f"the arm yields {much} {whose}"


def _doubt(said: str, times: float, low: float, high: float) -> Scale | None:
    """The sentence, where `times` lies outside; units that bring it inside, the likeliest first."""
    if low < times < high:
        return None
    softer = times > high
    middle = np.sqrt(low * high)
    reach = high / middle  # within it, the unit is as good as any other
    off = {
        soft if softer else stiff: abs(np.log(times / middle / (unit if softer else 1.0 / unit)))
        for unit, soft, stiff in UNITS
    }
    likely = [words for words in sorted(off, key=lambda w: off[w]) if off[words] < np.log(reach)]
    near = low / NEARBY < times < high * NEARBY
    units = [*likely[:MOST_UNITS], *([SOFTER if softer else STIFFER] if near and likely else [])]
    guess = f" {'Perhaps' if near else 'Likely'}: {'; or '.join(units)}." if units else ""
    return Scale(
        f"{said}: check the units of displacement and force.{guess} All springs together, the "
        "force's scale and the reading's scale are one number to these readings: which of them is "
        "wrong they cannot tell",
        certain=max(times, 1.0 / times) > CERTAIN,
    )
