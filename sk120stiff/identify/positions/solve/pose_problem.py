"""The least-squares problem of single numbers: each channel's gap over its own uncertainty."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index, Mask, rms
from sk120stiff.effects.geometry import JointOffset, ToolOffset
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.effects.marker_shift import MarkerShift
from sk120stiff.effects.options import Options
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.solve.pose_errors import PoseWhitening
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.measurements import Channels, Measurements
from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import ANGLES, OF_AXES, inclined
from sk120stiff.model import Model, Parameter
from sk120stiff.model.pose_reading import instrument_frames, move_by_load, read_poses

AT_THE_END = 3.0  # standard deviations of errors of geometry at which the plausible ones end
ROUGH = 2.0  # m; how far a marker may be off a place that is only roughly known


def absolute_of(readings: Measurements) -> Absolute:
    """What readings say of where markers stand.

    Raises:
        InputError: They are displacements of one point.
    """
    if readings.absolute is None:
        raise InputError("there are no positions", where=readings.place)
    return readings.absolute


@dataclass(frozen=True, eq=False)
class PoseProblem(Problem):
    """A model and readings of where markers stand.

    Attributes:
        sigma: Standard uncertainty of each kind of channel that did not state its own [m or rad].
        common: Standard size of what a pose has of its own, as joints that stand off by as much
            [rad or m], see `pose_errors.py`; 0: nothing.
        turning: How many times as far as these the tool turns of its own, beside its shift.
    """

    sigma: Mapping[str, float] = field(default_factory=dict)
    common: float = 0.0
    turning: float = 1.0

    def __post_init__(self) -> None:
        absolute_of(self.measurements)

    @property
    def said(self) -> Absolute:
        """What the readings say beside their numbers."""
        return absolute_of(self.measurements)

    @property
    def channels(self) -> Channels:
        """The readings."""
        return self.said.channels

    @cached_property
    def rows(self) -> Index:
        """(M,) reading that each channel belongs to."""
        return self.channels.rows

    @cached_property
    def lengths(self) -> Index:
        """Channels that are lengths, not angles."""
        parts = zip(self.channels.present, self.channels.kinds, strict=True)
        picked = [np.arange(part.start, part.stop) for kind, part in parts if kind not in ANGLES]
        return np.concatenate([*picked, np.zeros(0, dtype=np.intp)]).astype(np.intp)

    @property
    def counted(self) -> Index:
        """Channels whose gap is told as one size: lengths, and angles where nothing else is."""
        return self.lengths if len(self.lengths) else np.arange(len(self.rows))

    @property
    def unit(self) -> str:
        """Of a millionth of that size: µm, or µrad where no reading is a length."""
        return "µm" if len(self.lengths) else "µrad"

    @property
    def rms_unit(self) -> str:
        """What an rms over `counted` is in: µm rms, per axis where all of them have axes."""
        angles = not len(self.lengths)
        told = [kind for kind in self.channels.present if (kind in ANGLES) == angles]
        return f"{self.unit} rms" + (" per axis" if set(told) <= set(OF_AXES) else "")

    @cached_property
    def sigma_of_channels(self) -> Array:
        """(M,) standard uncertainty of every channel by itself [m or rad]."""
        scales = []
        for kind in self.channels.present:
            scale = self.channels.scale(kind)
            scales.append(scale if self.channels.stated(kind) else scale * self.sigma[kind])
        return np.concatenate(scales)

    @cached_property
    def of_channels(self) -> PoseWhitening:
        """How uncertain every channel is, and what those of a pose have in common."""
        sigma = self.sigma_of_channels
        if self.common == 0.0:
            return PoseWhitening(sigma)
        return PoseWhitening(sigma, self.own_ways, self.pose_of_channels, self.common)

    @property
    def own_ways(self) -> Array:
        """(M, k) the ways of `by_pose` with the turn as large as it is beside the shift."""
        return self.by_pose * np.where(self.turns, self.turning, 1.0)

    @property
    def pose_of_channels(self) -> Index:
        """(M,) pose of each channel."""
        return np.asarray(self.load_cases.pose[self.rows], dtype=np.intp)

    @cached_property
    def by_pose(self) -> Array:
        """(M, 6) what may be a pose's own: its tool is shifted and turned, every way alike.

        As large as joints make it that stand off by one each. Offsets of the joints themselves
        would let what all poses share, the wrong zero of a joint, pass for a draw of each: arms
        were registered worse by it than by plain least squares. Of what a load does alone, each
        joint yields otherwise.
        """
        if self.channels.displacements_alone:
            return self.by_joints
        cases, channels = self.load_cases, self.channels
        beside, offsets = self._with_offsets
        seen = read_poses(beside, cases, beside.values, derivative=True)
        each = np.sqrt((seen.columns[:, :, offsets] ** 2).sum(axis=2))  # (N, 6)
        shift, turn = (rms(part) for part in (each[:, :3], each[:, 3:]))
        R, origin = instrument_frames(beside, cases)
        to_base = np.swapaxes(R, 1, 2)
        marker = np.einsum("nij,nj->ni", to_base, seen.position - origin)
        pose = np.unique(cases.pose, return_inverse=True)[1]
        sums = np.stack([np.bincount(pose, axis) for axis in marker.T], axis=1)
        about = (sums / np.bincount(pose)[:, None])[pose, None]
        motion = np.zeros((cases.count, 6, 6))
        motion[:, :3, :3] = shift * R
        motion[:, :3, 3:] = (
            turn * R @ np.swapaxes(np.cross(np.eye(3), marker[:, None] - about), 1, 2)
        )
        motion[:, 3:, 3:] = turn * R
        moved = tilted = None
        if channels.by_load:
            still = move_by_load(self.model, cases, self.model.values)
            moved = replace(still, columns=np.zeros_like(motion))
        if channels.level is not None:
            tilted = inclined(channels.level, seen.standing, to_base @ motion[:, 3:], self._down)
        return channels.project(seen.position, seen.rotation, motion, moved, tilted)[1]

    @property
    def turns(self) -> Mask:
        """(k,) which of the ways of `by_pose` turn the tool; of what a load does alone, none."""
        count = self.by_pose.shape[1]
        turning = np.arange(count) >= 3
        return turning & (not self.channels.displacements_alone)

    @cached_property
    def by_joints(self) -> Array:
        """(M, n) derivative of the readings by an offset of each actuated joint [m or rad by rad].

        Of what a load does alone, by the twist that each joint yields more, rms over the readings:
        a drive that is softer at one pose is so under every load there. Rigid ones yield nothing.
        """
        if self.channels.displacements_alone:
            return self._by_springs
        beside, offsets = self._with_offsets
        slope = replace(self, model=beside, common=0.0).channel_gap(beside.values, derivative=True)
        return np.asarray(slope[1][:, offsets])

    @cached_property
    def _with_offsets(self) -> tuple[Model, Index]:
        """The model with an offset of every actuated joint, and where these stand."""
        model = self.model
        robot = model.robot
        own = {effect.id for effect in model.effects}
        for joint in robot.actuated:
            effect = JointOffset.at(robot, joint, Options())
            if effect.id not in own:
                model = model + [Parameter(effect, spec, 0.0) for spec in effect.parameters]
        places = [
            next(
                k for k, p in enumerate(model.parameters)
                if p.effect.name == JointOffset.name and p.effect.where == joint
            )
            for joint in robot.actuated
        ]  # fmt: skip
        return model, np.array(places, dtype=np.intp)

    @cached_property
    def _by_springs(self) -> Array:
        """(M, n) derivative by the twist of each joint's spring, the same share more everywhere."""
        robot, cases = self.model.robot, self.load_cases
        slope = replace(self, common=0.0).channel_gap(self.model.values, derivative=True)[1]
        torques = robot.screws(cases.a, point=cases.force_point).torques(cases.wrench)
        out, twists = np.zeros((len(slope), robot.n)), np.zeros((cases.count, robot.n))
        for k, parameter in enumerate(self.model.parameters):
            if parameter.effect.joint_spring:
                j = robot.actuated.index(parameter.effect.where)
                out[:, j] = slope[:, k] * parameter.internal
                twists[:, j] = torques[:, j] * parameter.internal
        usual = rms(twists)
        return out / usual if usual > 0.0 else out

    @cached_property
    def known(self) -> Mask:
        """(M,) channels of kinds whose uncertainty is stated; that of the others is fitted."""
        out = np.zeros(len(self.rows), dtype=np.bool_)
        for kind, part in zip(self.channels.present, self.channels.kinds, strict=True):
            out[part] = self.channels.stated(kind)
        return out

    @property
    def judged(self) -> Mask | None:
        """See `Problem.judged`."""
        return None if self.known.all() or not self.known.any() else self.known

    @property
    def stated_sigma(self) -> float | None:
        """Stated uncertainty of what `counted` tells [m or rad], rms; None where none is."""
        own = self.sigma_of_channels[self.counted][self.known[self.counted]]
        return rms(own) if len(own) else None

    @property
    def whitener(self) -> PoseWhitening:  # type: ignore[override]
        """See `Problem.whitener`."""
        return self.of_channels

    @cached_property
    def plausible(self) -> Array:
        """(P_free,) sizes in scaled units beyond which a value is implausible."""
        sizes = [self.reach(self.model.parameters[k]) for k in self.free]
        return np.array(sizes) / self.scale

    @property
    def span(self) -> Array:
        """See `Problem.span`: what is plausible."""
        return self.plausible

    def reach(self, parameter: Parameter) -> float:
        """Size beyond which a value is implausible; a marker that is fitted may sit anywhere."""
        rough = self.said.fit_point and isinstance(parameter.effect, ToolOffset | MarkerShift)
        return ROUGH if rough else parameter.spec.plausible

    @cached_property
    def prior(self) -> Array:
        """(P_free,) widths in scaled units within which values are sought.

        Waves over a short range of a joint are much alike; of those that fit, the small ones. Of
        small errors of geometry what is plausible is the end of what is met, not its width: taken
        for that, few poses foretell others twice as badly.
        """
        usual = self.span.copy()
        for j, k in enumerate(self.free):
            parameter = self.model.parameters[k]
            if isinstance(parameter.effect, JointFrame):
                usual[j] /= AT_THE_END
            elif isinstance(parameter.effect, TransmissionError):
                usual[j] = parameter.spec.usual
                usual[j] /= self.scale[j]
        return usual

    @cached_property
    def centre(self) -> Array:
        """(P_free,) values in scaled units about which they are sought.

        Of joint frames and waves that is none, of a marker its stated place, wherever an earlier
        fit left them: what the readings hardly tell would otherwise wander off, fit by fit.
        """
        effects = [self.model.parameters[k].effect for k in self.free]
        hardly = JointFrame | TransmissionError | ToolOffset | MarkerShift
        kept = [not isinstance(effect, hardly) for effect in effects]
        return np.asarray(self.start * kept)

    def channel_gap(self, values: Array, *, derivative: bool = False) -> tuple[Array, Array]:
        """Gap (M,) measured minus predicted, and derivative (M, P) of the prediction."""
        seen = read_poses(self.model, self.load_cases, values, derivative=derivative)
        moved, tilted = None, None
        if self.channels.by_load:
            moved = move_by_load(self.model, self.load_cases, values, derivative=derivative)
        if self.channels.level is not None:
            tilted = inclined(self.channels.level, seen.standing, seen.turning, self._down)
        return self.channels.project(seen.position, seen.rotation, seen.columns, moved, tilted)

    @cached_property
    def _down(self) -> Array:
        """(3,) where gravity points to, base axes."""
        down = self.model.robot.gravity_in_base
        size = float(np.linalg.norm(down))
        if size == 0.0:
            raise InputError(
                "inclinations are told against gravity, and gravity is stated to be 0",
                where=self.measurements.place,
                remedy="Write gravity: [0, 0, -9.81], or where it points to, into the YAML file.",
            )
        return np.asarray(down / size)

    def gap(self, x: Array) -> Array:
        """(L,) measured minus predicted of all channels that are lengths [m]."""
        return self.channel_gap(self.values(x))[0][self.lengths]

    def distances(self, gap: Array) -> Array:
        """(N,) length of a gap (M,) at every row [m]; NaN of one without a whole position."""
        if "position" not in self.channels.present:
            return np.full(self.channels.count, np.nan)
        held = self.channels.held("position")
        full = np.full(held.shape, np.nan)
        full[held] = gap[self.channels.kinds[0]]
        return np.asarray(np.linalg.norm(full, axis=1))

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """Whitened gap (M,) and its derivative (M, P_free) by `x`."""
        gap, slope = self.channel_gap(self.values(x), derivative=True)
        white = self.of_channels.apply
        return white(gap), -white(slope[:, self.free] * self.scale)
