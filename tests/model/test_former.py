"""Model files of earlier versions, and the words that stand in those of today."""

import pytest

from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.model import model_from_text, model_text

OLD = """
robot: motoman_sk120
effects:
  - name: force_bias
    where: sensor
    parameters:
      force_x: {value: 29.0, unit: N, std: 2.0}
      force_y: {value: 0.0, unit: N}
      force_z: {value: -4.0, unit: N}
"""


def test_a_former_name_is_read_with_the_other_sign_and_told() -> None:
    with pytest.warns(ToolkitWarning, match="true minus reported") as told:
        model = model_from_text(OLD)
    offset = model.parameter("force_bias:sensor.offset_x")
    assert (offset.value, offset.std) == (-29.0, 2.0)
    assert model.parameter("force_bias:sensor.offset_z").value == 4.0
    assert len(told) == 1


def test_both_names_at_once_are_refused() -> None:
    both = OLD + "      offset_x: {value: -29.0, unit: N}\n"
    with pytest.raises(InputError, match="opposite signs"):
        model_from_text(both)


def test_a_model_file_says_what_its_values_mean() -> None:
    with pytest.warns(ToolkitWarning):
        model = model_from_text(OLD)
    text = model_text(model)
    assert "# F_reported - F_true = b" in text
    assert "# offset_x [N]: reported minus true force along x of the tool frame" in text
    again = model_from_text(text)
    assert again.parameter("force_bias:sensor.offset_x").value == -29.0
    assert model_text(again) == text
