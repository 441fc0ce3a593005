"""The model that a calibration starts from: frame, marker, payload and geometry beside its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import CATALOGUE, Catalogue, Elastic
from sk120stiff.effects.options import Options
from sk120stiff.effects.payload_mass import distinct
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.placing.placing import Placing
from sk120stiff.model import Model, Parameter

REGISTERED = "registered"


def options_of(readings: Measurements) -> Options:
    """What effects may be told of readings."""
    said = readings.absolute
    labels = () if said is None or said.groups is None else tuple(dict.fromkeys(said.groups))
    return Options(
        poses=readings.poses,
        timed=readings.time is not None,
        series=labels,
        stations=("",) if said is None else said.stood[0],
        thermal=said is not None and said.temperature is not None,
        rotations=said is not None and said.channels.rotation is not None,
        masses=() if said is None else distinct(said.payload.tolist()),
        hung=said is not None and bool(said.payload.any()) and not readings.wrench.any(),
    )


def started(
    model: Model,
    readings: Measurements,
    placed: Placing | None,
    *,
    geometry: bool,
    mounted: Array | None = None,
    catalogue: Catalogue = CATALOGUE,
) -> Model:
    """The model with frame, marker, payload and geometry beside what it has.

    `mounted`: (G, 3) rotation vectors of targets on the tool; None: their axes are the tool's.

    Raises:
        InputError: A marker's place is wanted, and only displacements were read.
    """
    said, robot, told = readings.absolute, model.robot, options_of(readings)
    if said is None:
        return model
    present = {effect.id for effect in model.effects}

    def joined(model: Model, name: str, where: str, values: Array | None = None) -> Model:
        effect = catalogue.effect(robot, name, where, told)
        if effect.id in present and values is not None:
            return _standing_there(model, effect.id, values)
        if effect.id in present or not effect.parameters:
            return model
        internal = np.zeros(len(effect.parameters)) if values is None else values
        return model + [
            Parameter(effect, spec, float(value), origin=REGISTERED)
            for spec, value in zip(effect.parameters, internal, strict=True)
        ]

    if said.frame == "unknown" and placed is not None:
        frame = np.concatenate([placed.shift, placed.turn], axis=1).ravel()
        model = joined(model, "tracker_frame", "tracker", frame)
    if said.fit_point and said.channels.displacements_alone:
        raise InputError(
            "how far a marker goes under a load does not tell where it sits",
            where=f"{readings.path or 'measurements'}, its YAML file, fit",
            remedy="State its place and leave 'fit' out; or write where it stood, with and without "
            "load: x y z.",
        )
    if said.fit_point:
        marker = np.zeros(3) if placed is None else placed.marker
        model = joined(model, "tool_offset", robot.tool_frame, marker)
        if said.groups is not None:
            apart = None if placed is None or len(placed.apart) == 1 else placed.apart[1:].ravel()
            model = joined(model, "marker_shift", robot.tool_frame, apart)
    elif said.series is not None and len(set(said.series)) > 1:
        model = joined(model, "marker_shift", robot.tool_frame)
    if mounted is not None:
        model = joined(model, "target_rotation", robot.tool_frame, mounted.ravel())
    if said.fit_payload:
        model = joined(model, "payload", robot.tool_frame)
    # Nobody knows to the millimetre where a mass's centre lies; several masses tell it.
    unplaced = geometry and not said.payload_placed and not readings.wrench.any()
    if said.payload_differs and (said.fit_payload or unplaced):
        model = joined(model, "force_point", "sensor")
    if geometry:
        for where in catalogue["joint_frame"].places(robot):
            model = joined(model, "joint_frame", where)
    return model


def _standing_there(model: Model, name: str, values: Array) -> Model:
    """The model of an earlier campaign, instrument or marker where they stand in this one."""
    own = [k for k, p in enumerate(model.parameters) if p.effect.id == name]
    if len(own) != len(values):  # more stations or markers than before, or fewer
        return model
    parameters = list(model.parameters)
    for k, value in zip(own, values, strict=True):
        if parameters[k].free:
            parameters[k] = replace(parameters[k], internal=float(value))
    return replace(model, parameters=tuple(parameters))


def loaded(model: Model, readings: Measurements) -> tuple[Model, list[str]]:
    """The model without springs where nothing bends them, and a sentence on that."""
    said = readings.absolute
    weighs = model.robot.mechanism().chain.weighs and model.robot.gravity.any()
    hung = said is not None and bool(said.payload.any()) and bool(model.robot.gravity.any())
    if weighs or hung or readings.wrench.any():
        if said is None or not hung or model.robot.mechanism().chain.weighs:
            return model, []
        other = (
            "." if said.payload_differs
            else ", or read each pose under two payloads: by what they differ springs are told "
            "without it. The springs' errors hold what it may do."
        )  # fmt: skip
        return model, [
            "The URDF states no masses: what the arm's own weight does is not in the model, and "
            f"springs and waves may stand for it. State the masses{other}"
        ]
    springs = [effect.id for effect in model.effects if isinstance(effect, Elastic)]
    for name in springs:
        model = model.without(name)
    why = (
        "the URDF states no masses" if not model.robot.mechanism().chain.weighs else "gravity is 0"
    )
    return model, [
        f"Nothing bends this arm as far as is known: {why}, and no payload and no load is stated. "
        "Springs cannot be told from these positions; geometry can. Waves and frames stand for "
        "what sag there is."
    ]
