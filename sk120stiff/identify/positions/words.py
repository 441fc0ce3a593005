"""A calibration in words: what was found, what cannot be told, what was set aside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.effects import Elastic, Viewpoint
from sk120stiff.errors import listed, micro
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.acting_alike import acting_alike
from sk120stiff.identify.positions.checks.mistyped_joint import mistyped_joints
from sk120stiff.identify.positions.residuals.line_of_sight import by_line_of_sight
from sk120stiff.identify.positions.residuals.pure_error import pure_error
from sk120stiff.identify.positions.residuals.remainder import remainder_at_other_poses
from sk120stiff.identify.positions.solve.minimal_parameters import Frozen
from sk120stiff.identify.solve.polish import FAINTEST
from sk120stiff.identify.uncertainty.known_model import known_estimates
from sk120stiff.identify.uncertainty.parts import mostly_parts
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.stated_sizes import heavier_than_the_arm
from sk120stiff.model import Model, Parameter, told_implausible

SURE = 3.0  # standard errors by which a mass is less than nothing
MUCH_LESS, SURELY = 0.5, 0.999  # of the stated noise, and the probability that it leaves more
WAVES = 4  # unknowns of a joint: sine and cosine of one turn and of half of it
SHOWN = 12  # frozen parameters and rows that are told one by one

NO_TORQUE = "neither weight nor payload nor load puts a torque on it that shows"
ABOUT = "distances to points in one line tell it together with a turn about them only"
SHARED = "these positions tell it together with errors of geometry only"


def known_calibration(found: Calibration) -> Model:
    """The fitted model with its uncertainty, as it is written to a file.

    What a cause that it lacks does at poses like these is in what is left, not in what the values
    that stand for it foretell there.
    """
    problem = found.problem
    sigma = None
    if len(problem.lengths):
        sigma = problem.stated_sigma or (noise_of(found) if problem.common else found.rms)
    source = f"{found.problem.load_cases.count} readings of positions"
    alike = replace(found, omitted=found.moves.omitted + found.moves.foreign, foreign=None)
    known = known_estimates(alike, sigma, source)
    return found.model.known(replace(known, remainder=remainder_at_other_poses(found)))


def noise_of(found: Calibration) -> float:
    """What readings of one pose differ by beyond the model, rms [m or rad]."""
    own = found.problem.of_channels.sigma[found.problem.counted]
    return rms(own) * found.unit


def gap_sentence(found: Calibration) -> str:
    """How far positions are off the model, and what the noise is taken to be."""
    problem = found.problem
    distances, angles = found.distances, angle_gap(found)
    sizes = [
        *([f"{micro(found.rms)} {problem.rms_unit}"] if len(problem.lengths) else []),
        *([f"{micro(distances.mean())} µm mean distance"] if len(distances) else []),
        *([f"{micro(rms(angles))} µrad rms of angles"] if len(angles) else []),
    ]
    said = (
        f"Gap {', '.join(sizes)}, over {len(problem.rows)} numbers of "
        f"{problem.load_cases.count} readings; {found.estimated} values estimated."
    )
    unstated = [kind for kind in problem.channels.present if not problem.channels.stated(kind)]
    if unstated:
        whole = len(unstated) == len(problem.channels.present)
        of = "" if whole else f" of {listed(unstated)}"
        said += f" No uncertainty{of} is stated; "
        if problem.common and len(problem.lengths):
            noise = f"{micro(noise_of(found))} {problem.rms_unit}"
            said += f"what differs between the readings of a pose tells it: {noise}."
        else:
            said += "the gap itself is taken for it."
            again = pure_error(found)
            if again is not None:
                size = f"{micro(again.sigma)} {problem.unit}"
                said += (
                    f" Repeats of one pose and load tell {size} for one reading ({again.freedom} "
                    "degrees of freedom): state that, and what is left beyond it is told."
                )
        if whole:
            return said
        others = [kind for kind in problem.channels.present if kind not in unstated]
        said += f" Of {listed(others)}:"
    if found.exceeds:
        wider = "hold what a pose's readings share" if problem.common else "are larger by as much"
        return (
            f"{said} That is {found.noise_factor:.3g} times the stated uncertainty: more is at "
            f"work than is in the model, and the standard errors {wider}."
        )
    if found.misfit is not None and found.misfit[2] > SURELY and found.noise_factor < MUCH_LESS:
        return (
            f"{said} That is only {found.noise_factor:.2g} times the stated uncertainty, on which "
            "the standard errors rest: check its number and its unit."
        )
    return f"{said} That agrees with the stated uncertainty."


def angle_gap(found: Calibration) -> Array:
    """(K,) what is left of every channel that is an angle [rad]."""
    problem = found.problem
    return np.delete(problem.of_channels.undo(found.residual), problem.lengths)


def unseen(found: Calibration) -> dict[str, str]:
    """Full name → reason, for every estimated parameter that the positions do not determine."""
    about = ABOUT if "position" not in found.problem.channels.present else SHARED
    alone = np.linalg.norm(found.jacobian, axis=0) * found.problem.span > FAINTEST
    return {
        p.name: (about if isinstance(p.effect, Viewpoint) else SHARED) if shows else NO_TORQUE
        for p, known, shows in zip(found.parameters, found.identifiable, alone, strict=True)
        if not known
    }


def _branches(readings: Measurements) -> list[str]:
    """What is not sought, though a column may suggest it."""
    if not {"load", "unload"} <= set(readings.branch or ()):
        return []
    return [
        "Friction is not sought of such readings, though the column branch tells loads that rise "
        "from loads that fall: it keeps both from counting as repeats, and is not used otherwise. "
        "What friction does stays in what is left. It is sought of displacements of one point "
        "without turns: columns dx, dy, dz, with blank cells where an axis was not read."
    ]


def findings(found: Calibration, readings: Measurements) -> list[str]:
    """Everything beside the numbers, in sentences."""
    said = [*found.notes, *mostly_parts(found)]
    if found.placed is not None:
        said.insert(0, f"Rigid robot placed: {1e3 * found.placed.rms:.3g} mm rms distance left.")
    said.append(gap_sentence(found))
    said += by_line_of_sight(found)
    said += _branches(readings)
    said += _hung(found, readings) + _payload(found, readings) + _by_weight(found, readings)
    said += _implausible(found)
    if found.waves:
        said.append(
            f"Waves over the joints' angles show beyond doubt ({', '.join(found.waves)}) and are "
            "in the model: springs would take them for sag. A joint's waves show together; of a "
            "joint that moves little single values are less sure."
        )
    said += _few(found)
    said += [f"{name} cannot be seen: {why}." for name, why in unseen(found).items()]
    said += _rigid(found) + acting_alike(found)
    said += [f"{joint} never moves: what is beyond it moves as one." for joint in found.still]
    if unshown := [item for item in found.frozen if not item.inside]:
        said.append(f"{_errors(unshown)} show in none of these readings and are left as they are.")
    if shared := [item for item in found.frozen if item.inside]:
        said.append(f"{_errors(shared)} cannot be told apart here:")
        said += _some([f"  {item.sentence()}" for item in shared])
    rows = np.flatnonzero(found.wild)
    if len(rows):
        lie = (
            "1 row lies far off all others and was"
            if len(rows) == 1
            else (f"{len(rows)} rows lie far off all others and were")
        )
        said.append(f"{lie} set aside:")
        said += _some([_wild(found, readings, int(row)) for row in rows])
        said += [f"  {each}" for each in mistyped_joints(found, readings, SHOWN)]
    return said


def missing_sentences(found: Calibration) -> list[str]:
    """That something is missing, or may be, as far as anything tells."""
    if found.lacks:
        return [
            "Causes that the model does not have would take more off what is left than chance "
            "allows, and would move values by as much as the standard errors hold. What is missing "
            "is what 'sk120stiff explain' looks for."
        ]
    if found.exceeds:
        return ["What is missing is what 'sk120stiff explain' looks for."]
    if not found.sigma_known:  # its errors rest on the model
        return ["Whether something is missing is what 'sk120stiff explain' looks for."]
    return []


def _errors(frozen: Sequence[Frozen]) -> str:
    return (
        "1 small error of geometry"
        if len(frozen) == 1
        else (f"{len(frozen)} small errors of geometry")
    )


def _few(found: Calibration) -> list[str]:
    """That too little is left over for waves to show, which springs then stand for."""
    waves = WAVES * len(found.model.robot.actuated)
    springs = any(isinstance(p.effect, Elastic) for p in found.parameters)
    if found.waves or not springs or found.degrees_of_freedom >= waves:
        return []
    return [
        f"Only {found.degrees_of_freedom} numbers are left over: waves over the joints' angles "
        f"({waves} unknowns) could not show. That there may be such as gears usually have is in "
        "the standard errors; larger ones are not. Measure more poses."
    ]


def implausible(found: Calibration) -> list[Parameter]:
    """Parameters that came out larger than any arm has them."""
    reach, hidden = found.problem.reach, unseen(found)
    shown = (p for p in found.model.parameters if p.name not in hidden)
    return [p for p in shown if abs(p.internal) > reach(p)]


def _implausible(found: Calibration) -> list[str]:
    """That values came out larger than any arm has them."""
    far = implausible(found)
    return [told_implausible(far)] if far else []


def _rigid(found: Calibration) -> list[str]:
    """What it means that a value stands on its bound, or that its interval has no end."""
    hidden, said = unseen(found), list[str]()
    held = [p for p, at in zip(found.parameters, found.at_bound, strict=True) if at]
    soft = [p.name for p in held if isinstance(p.effect, Elastic) and p.name not in hidden]
    rest = [p.name for p in held if p.name not in (*soft, *hidden)]
    if soft:
        come, have, one = ("comes", "has", "it") if len(soft) == 1 else ("come", "have", "them")
        said.append(
            f"{listed(soft)} {come} out rigid (inf) and {have} no ±: any softer, and the model "
            f"would be further off. How soft the readings would let {one} be is the lower end."
        )
    if rest:
        stand = "stands on its bound" if len(rest) == 1 else "stand on their bounds"
        said.append(f"{listed(rest)} {stand}: the readings would have it beyond, where nothing is.")
    by_noise = np.diag(found.covariance) - np.diag(found.moves.covariance)
    beyond = found.x > found.reach() * np.sqrt(np.maximum(by_noise, 0.0))
    ends = zip(found.parameters, found.intervals(), beyond, strict=True)
    open_ = {
        p.name: bool(seen)
        for p, (_, high), seen in ends
        if np.isinf(high) and p.name not in (*hidden, *soft)
    }
    for surely, tail in (
        (False, "."),
        (True, ", though noise alone leaves none of that: what the model lacks may do as much."),
    ):
        if names := [name for name, seen in open_.items() if seen == surely]:
            reach = "interval of {} reaches" if len(names) == 1 else "intervals of {} reach"
            said.append(f"The {reach.format(listed(names))} up to rigid (inf){tail}")
    return said


def _hung(found: Calibration, readings: Measurements) -> list[str]:
    """That nobody said where the payload hangs, though springs rest on it."""
    said = readings.absolute
    if said is None or said.payload_placed or not said.payload.any():
        return []
    if not any(isinstance(effect, Elastic) for effect in found.model.effects):
        return []
    place = [p for p in found.model.parameters if p.effect.name == "force_point"]
    if place and not said.fit_payload and not {p.name for p in place} & {*unseen(found)}:
        at = zip(said.payload_point, place, strict=True)
        told = ", ".join(
            f"{1e3 * (there + p.internal):.3g} ± {1e3 * (p.internal_std or 0.0):.2g}"
            for there, p in at
        )
        return [
            "The file does not say where the payload hangs; that its mass differs tells it: its "
            f"centre lies at ({told}) mm in {found.model.robot.tool_frame}."
        ]
    if place or any(effect.name == "payload" for effect in found.model.effects):
        return []
    return [
        "Where the payload hangs is not stated: it is taken to be the origin of "
        f"{found.model.robot.tool_frame}, and springs rest on that. Write the centre of its mass "
        "as payload.point into the YAML file, or payload: {fit: true}."
    ]


def _by_weight(found: Calibration, readings: Measurements) -> list[str]:
    """That springs rest on the arm's own weight alone, of which no file is sure."""
    said, hidden = readings.absolute, unseen(found)
    springs = [
        p for p in found.parameters if isinstance(p.effect, Elastic) and p.name not in hidden
    ]
    own = {effect.name for effect in found.model.effects} & {"link_masses", "gravity_compensator"}
    if said is None or not springs or own or readings.wrench[readings.use].any():
        return []
    if said.payload[readings.use].any():
        return []
    return [
        "Nothing but the arm's own weight bends it here, so springs are as right as its masses in "
        f"the URDF ({found.model.robot.total_mass:.3g} kg) and as it has no balancer that the URDF "
        "does not know: where these masses are 10 % too small every spring comes out 10 % too "
        "soft, and no ± here knows of it. Positions with a known payload beside those without it "
        "would tell."
    ]


def _payload(found: Calibration, readings: Measurements) -> list[str]:
    """That a payload was found that no arm carries, or that weighs less than nothing."""
    own = [p for p in found.parameters if p.effect.name == "payload" and p.spec.name == "mass"]
    if not own or readings.absolute is None or own[0].name in unseen(found):
        return []
    stated = readings.absolute.payload[readings.use]
    mass, error = own[0].internal, own[0].internal_std or 0.0
    lightest, heaviest = float(stated.min()) + mass, float(stated.max()) + mass
    if lightest < -SURE * error:
        return [
            f"With the payload that was found the tool carries {lightest:.3g} kg: no mass is "
            "negative. Check the stated payloads and the masses of the last links in the URDF."
        ]
    return heavier_than_the_arm(heaviest, found.model.robot.total_mass, "comes out as")


def _wild(found: Calibration, readings: Measurements, row: int) -> str:
    off = np.nan if found.placed is None else found.placed.distance[row]
    far = f": {1e3 * off:.3g} mm off the placed rigid robot" if np.isfinite(off) else ""
    return f"  line {readings.line[row]} (pose {readings.pose[row]}){far}"


def _some(lines: Sequence[str]) -> list[str]:
    if len(lines) <= SHOWN:
        return list(lines)
    return [*lines[:SHOWN], f"  ... and {len(lines) - SHOWN} more."]
