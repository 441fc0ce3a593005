"""What an effect may be told beside its place."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Options:
    """What an effect may be told beside its place.

    Attributes:
        poses: Poses of the experiment, for `zero_offset`.
        timed: The experiment has times, for `reading_drift`.
        breaks: Torques [N·m] at which a gear changes its stiffness, for `gear_hardening`.
        series: Series of the experiment, for `marker_shift` and `target_rotation`.
        stations: Where the instrument stood, for `tracker_frame`; one without a label is "".
        thermal: The experiment has temperatures, for `thermal_growth`.
        rotations: Rotations of the tool were read, for `target_rotation`.
        hung: The loads are masses on the tool, for `force_point`.
        masses: Payloads of the experiment that differ [kg], for `payload_mass`.
        shape: Names of the parameters of the law that is meant, for effects that know more than
            one.
    """

    poses: tuple[str, ...] = ()
    timed: bool = False
    breaks: tuple[float, ...] = ()
    series: tuple[str, ...] = ()
    stations: tuple[str, ...] = ("",)
    thermal: bool = False
    rotations: bool = False
    hung: bool = False
    masses: tuple[float, ...] = ()
    shape: tuple[str, ...] = ()
