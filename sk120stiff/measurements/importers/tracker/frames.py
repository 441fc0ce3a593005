"""Where the tracker stood: the rigid robot laid onto positions, and what follows for their axes."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError, Refusal, listed
from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.told import Mode, Told
from sk120stiff.measurements.placing.cloud import FEWEST, Cloud
from sk120stiff.measurements.placing.placing import FITS, place
from sk120stiff.measurements.placing.registration import Registration, register
from sk120stiff.measurements.placing.slips import Convention
from sk120stiff.measurements.placing.under_load import refuse_far_under_load
from sk120stiff.measurements.placing.untold import with_told_place
from sk120stiff.measurements.placing.upside_down import OtherConvention
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import rotation_vector

TURNED_ROUGHLY = np.radians(15.0)  # what a marker that sits elsewhere may turn a cloud by
SLIGHT = np.radians(0.5)  # errors of geometry turn a cloud by less
EITHER = 1.1  # times as much left by deviations of the other sign, which are not told apart then
VAGUE = np.radians(1.0)  # standard error of a turn that registers nothing


@dataclass(frozen=True, eq=False)
class Placed:
    """What `placed` found: fit, rows it rests on (P,), wild ones (N,), rms of the other sign."""

    fitted: Registration | None
    rows: Index
    wild: Mask
    reversed_rms: float | None
    doubts: tuple[str, ...]


def placed(draft: Draft, mode: Mode, robot: Robot, told: Told) -> Placed:
    """The rigid robot laid onto positions without load.

    Raises:
        Refusal: They are not this robot's.
        InputError: Many of those under load lie where none can have brought them.
    """
    nothing = Placed(None, np.zeros(0, int), np.zeros(len(draft.pose), bool), None, ())
    if mode == "displacements":
        return nothing
    rows = _unloaded(draft, mode)
    point, known = points_of(draft, told)
    every = Measurements(
        pose=tuple(f"{k}" for k in range(len(draft.pose))),
        joint_names=robot.actuated,
        joint_kinds=tuple(robot.kinds),
        joints=draft.joints.values,
        wrench=np.zeros((len(draft.pose), 6)),
        displacement=None,
        path=draft.sheet.path,
        line=np.array(draft.sheet.lines),
        absolute=Absolute(
            Channels(position=draft.measured),
            "unknown", point, not known, draft.marker_of, np.zeros(len(draft.pose)),
            stations=draft.stations, series=draft.series,
        ),
    )  # fmt: skip
    try:
        placing = place(robot, every.select(rows))
    except InputError as error:
        if isinstance(error, OtherConvention):
            raise _by_other_columns(error, draft, robot) from error
        raise Refusal(
            f"{error.what}. These are not this robot's positions as they stand",
            where=error.where,
            remedy=f"{error.remedy or ''} Units and columns are told by --length, --angle and "
            f"--joints. Understood: {_understood(draft)}.".strip(),
        ) from error
    if placing is None:
        return dataclasses.replace(
            nothing,
            doubts=("Fewer than three poses: whether they are this robot's was not checked.",),
        )
    kept = rows[~placing.wild]
    joints, names = draft.joints.values[kept], np.array(draft.mounts)[kept]
    screws = robot.screws(joints)
    markers = np.unique(names, return_inverse=True)[1]
    stood = stood_of(draft)[kept]
    places = np.column_stack([joints, markers, stood])
    again = len(kept) / len(np.unique(places, axis=0))  # what was read again errs alike

    def fit(x: Array) -> Registration | None:
        where, turn = screws.frame_position, screws.rotation
        found = register(
            x[kept], where, turn, point[kept],
            fit_marker=not known, group=np.zeros_like(markers) if known else markers,
            station=stood,
        )  # fmt: skip
        if found is None:
            return None
        cloud = Cloud(robot, joints, x[kept], point[kept], names, markers, stood)
        found = with_told_place(cloud, found, np.ones(len(kept), dtype=bool))[0]
        return dataclasses.replace(found, covariances=found.covariances * again)

    fitted = fit(draft.measured)
    if mode == "load pairs" and fitted is not None and len(fitted.apart) == 1:
        used = np.flatnonzero(draft.use & np.isfinite(draft.measured).all(axis=1))
        refuse_far_under_load(_cloud(draft, robot, point, used), fitted, every, used)
    other = None if draft.reversed is None else fit(draft.reversed)
    wild = np.zeros(len(draft.pose), bool)
    wild[rows[placing.wild]] = True
    doubts = list(placing.notes)
    if fitted and other and other.rms < fitted.rms:
        doubts.append(
            f"With deviations of the other sign (nominal minus measured) {1e3 * other.rms:.3g} mm "
            f"would be left, not {1e3 * fitted.rms:.3g} mm: ask where the file comes from."
        )
    elif fitted and other and other.rms < EITHER * fitted.rms:
        doubts.append(
            "These positions do not tell the sign of the deviations: measured minus nominal leaves "
            f"{1e3 * fitted.rms:.3g} mm, nominal minus measured {1e3 * other.rms:.3g} mm. With the "
            "wrong one a calibration makes the arm worse: ask where the file comes from."
        )
    return Placed(fitted, kept, wild, other.rms if other else None, tuple(doubts))


def _cloud(draft: Draft, robot: Robot, point: Array, rows: Index) -> Cloud:
    """Some rows of one marker, or of markers whose places are known (N, 3)."""
    parts = draft.joints.values[rows], draft.measured[rows], point[rows]
    one = np.zeros(len(rows), dtype=np.intp)
    return Cloud(robot, *parts, np.array(draft.mounts)[rows], one, stood_of(draft)[rows])


def _unloaded(draft: Draft, mode: Mode) -> Index:
    """Rows that the rigid robot is laid onto: of load pairs those under the lightest load."""
    rows = np.flatnonzero(draft.use)
    if mode == "load pairs":
        size = np.linalg.norm(draft.loads.wrench[rows], axis=1)
        rows = rows[np.lexsort((rows, size))]
        rows = np.sort(rows[np.unique(np.array(draft.pose)[rows], return_index=True)[1]])
    return np.asarray(rows, dtype=np.intp)


def laid_over(
    draft: Draft, mode: Mode, robot: Robot, told: Told, poses: NDArray[np.str_]
) -> tuple[Cloud, Registration] | None:
    """Positions with the robot laid onto them; None where no arm leaves as much, or a station or
    a series has fewer poses than tell it.

    Args:
        draft, mode, robot, told: As `placed` has them.
        poses: (N,) label of the pose of every row: what was read twice at one tells no more.
    """
    rows, (point, known) = _unloaded(draft, mode), points_of(draft, told)
    rows = rows[np.isfinite(draft.measured[rows]).all(axis=1)]
    stood = stood_of(draft)
    of = [np.array(own) for own in (draft.stations, draft.series) if own is not None]
    counts = [count for own in of for count in counted_poses(poses, own, rows).values()]
    if min([len(rows), *counts]) < FEWEST:
        return None
    x, names = draft.measured[rows], np.array(draft.mounts)[rows]
    group = np.unique(names, return_inverse=True)[1] * (not known)
    cloud = Cloud(robot, draft.joints.values[rows], x, point[rows], names, group, stood[rows])
    found = cloud.placed(fit_marker=not known)[0]
    spread = float(np.sqrt(((x - x.mean(axis=0)) ** 2).sum(axis=1).mean()))
    return (cloud, found) if found.rms < FITS * spread else None


def counted_poses(poses: NDArray[np.str_], labels: NDArray[np.str_], rows: Index) -> dict[str, int]:
    """Label → of how many poses these rows are; all of N labels, and 0 where no row is."""
    pairs = {(str(labels[k]), str(poses[k])) for k in rows}
    counts = dict.fromkeys((str(label) for label in labels), 0)
    for label, _ in pairs:
        counts[label] += 1
    return counts


def stood_of(draft: Draft) -> Index:
    """(N,) number of the station of every row, in the order in which they come."""
    labels = draft.stations or ("",) * len(draft.pose)
    names = list(dict.fromkeys(labels))
    return np.array([names.index(label) for label in labels], dtype=np.intp)


def _by_other_columns(error: OtherConvention, draft: Draft, robot: Robot) -> Refusal:
    """The same refusal by the names of the file's own columns."""
    (columns, shares, zeros), slides = draft.joints.sums, robot.prismatic

    def told(way: Convention) -> str:
        return f"--joints '{','.join(way.of(shares, zeros).expressions(columns, slides))}'"

    stands = error.standing
    return Refusal(
        f"{error.what}. These are not this robot's positions as they stand: the joint columns "
        "look like another controller's",
        where=error.where,
        remedy=f"Check its convention. If it is so, give {told(stands.way)}.{stands.beside(told)} "
        f"Understood: {_understood(draft)}.",
    )


def _understood(draft: Draft) -> str:
    """Format and columns in one line, for whoever must find the slip."""
    sheet = draft.sheet
    columns = [f"{c.header} as {c.meaning}" for c in sheet.columns]
    units = ", ".join(header for header, _ in (*draft.joints.written[:1], *draft.readings[:1]))
    return f"{sheet.title}; {', '.join(columns)}; units as in {units}"


def points_of(draft: Draft, told: Told) -> tuple[Array, bool]:
    """(N, 3) marker of each row in the tool frame [m], and whether its place was stated.

    Raises:
        InputError: One place was told of several markers.
    """
    names, places = draft.markers
    if told.point is not None and len(several := sorted(set(draft.marker_of))) > 1:
        raise InputError(
            f"one place was told, and the file has the markers {listed(several)}",
            where="--point",
            remedy="Leave it out: "
            + ("the file says where each sits." if places else "the fit finds where each sits."),
        )
    if told.point is not None:
        return np.tile(told.point, (len(draft.pose), 1)), True
    if places:
        return np.array([places[name] for name in names]), True
    return np.zeros((len(draft.pose), 3)), False


def axes(
    fitted: Registration | None, mode: Mode, into_base: bool | None, told: Told
) -> tuple[float | None, bool, list[str]]:
    """How far axes are turned [rad], whether to register, and what speaks against it."""
    if fitted is None:
        if into_base:
            raise InputError(
                "there are no positions that the tracker could be registered by"
                if mode == "displacements"
                else "fewer than three poses register no tracker",
                where="--register",
                remedy="Leave it out.",
            )
        return None, False, []
    turned = float(np.linalg.norm(rotation_vector(fitted.turns), axis=1).max())
    vague = float(fitted.std[:, :3].max()) > VAGUE
    if into_base:
        if vague:
            raise Refusal(
                "these positions do not tell how the tracker is turned: they lie on a line, or too "
                "close together",
                where="--register",
                remedy="Add poses that spread in space.",
            )
        return turned, True, []
    limit = SLIGHT if fitted.marker_fitted or told.point is not None else TURNED_ROUGHLY
    if mode == "positions" or turned < limit:
        return turned, False, []
    if into_base is None and not vague:
        return turned, True, []
    return turned, False, [
        f"The positions are turned by about {np.degrees(turned):.0f} deg against the base frame: "
        "displacements in other axes give wrong springs. "
        + ("They do not tell the turn well; measure poses that spread in space."
           if vague else "Let them be registered: --register.")
    ]  # fmt: skip
