"""Robot + effects with values: predict, differentiate, read, write."""

from sk120stiff.model.budget import Share, joint_shares, moved_by, shares, with_own_errors
from sk120stiff.model.compliance import (
    ModelCompliance,
    marker_off,
    model_compliance,
    probing_poses,
    seen_from,
    without_marker,
)
from sk120stiff.model.counted_from import counted_from, warn_of_references
from sk120stiff.model.file import (
    base_model,
    model_from_text,
    model_text,
    read_model,
    robot_of_model,
    write_model,
)
from sk120stiff.model.holding import held_loads, warn_of_far_bend
from sk120stiff.model.loaded import (
    LoadedStiffness,
    LoadedUncertainty,
    loaded_stiffness,
    loaded_uncertainty,
)
from sk120stiff.model.model import Model, joint_spring_model
from sk120stiff.model.parameter import (
    CALIBRATED,
    ON_BOUND,
    TOGETHER,
    UNSEEN,
    Parameter,
    parameter_frame,
)
from sk120stiff.model.pose_reading import instrument_frames
from sk120stiff.model.predicted import Predicted, predict, predict_with_uncertainty
from sk120stiff.model.typical import (
    implausible_geometry,
    told_implausible,
    typical_model,
    typical_parameters,
)
from sk120stiff.model.uncertainty import Remainder, Uncertainty

__all__ = [
    "CALIBRATED",
    "ON_BOUND",
    "TOGETHER",
    "UNSEEN",
    "LoadedStiffness",
    "LoadedUncertainty",
    "Model",
    "ModelCompliance",
    "Parameter",
    "Predicted",
    "Remainder",
    "Share",
    "Uncertainty",
    "base_model",
    "counted_from",
    "held_loads",
    "implausible_geometry",
    "instrument_frames",
    "joint_shares",
    "joint_spring_model",
    "loaded_stiffness",
    "loaded_uncertainty",
    "marker_off",
    "model_compliance",
    "model_from_text",
    "model_text",
    "moved_by",
    "parameter_frame",
    "predict",
    "predict_with_uncertainty",
    "probing_poses",
    "read_model",
    "robot_of_model",
    "seen_from",
    "shares",
    "told_implausible",
    "typical_model",
    "typical_parameters",
    "warn_of_far_bend",
    "warn_of_references",
    "with_own_errors",
    "without_marker",
    "write_model",
]
