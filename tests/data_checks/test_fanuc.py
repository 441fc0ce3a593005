"""A real arm whose controller measures joint 3 against the floor."""

from pathlib import Path

from sk120stiff.data_checks import find_slip, look, refuse_unbelievable
from sk120stiff.model import joint_spring_model
from tests.real_arms import fanuc

if fanuc.FOLDER.is_dir():

    def test_columns_as_the_controller_has_them_are_told(tmp_path: Path) -> None:
        arm = fanuc.robot(tmp_path, 1, 1, -1, -1, -1, -1)
        found = find_slip(arm, fanuc.readings(fanuc.CONTROLLER))
        assert found is not None
        assert "joint_3 seems to be measured against the floor" in found.said
        assert "The URDF's joint_3 is joint_3 + joint_2 of this file" in found.remedy
        assert len(found.corrections) == 1

    def test_with_turned_axes_the_whole_convention_is_told(tmp_path: Path) -> None:
        found = find_slip(fanuc.robot(tmp_path, 1, 1, 1, 1, 1, 1), fanuc.readings(fanuc.CONTROLLER))
        assert found is not None
        assert "The URDF's joint_3 is -joint_3 - joint_2 of this file" in found.remedy
        for k in (4, 5, 6):
            assert f"Negate the column joint_{k}." in found.remedy
        assert len(found.corrections) == 4

    def test_mapped_angles_are_not_doubted(tmp_path: Path) -> None:
        arm = fanuc.robot(tmp_path, 1, 1, 1, 1, 1, 1)
        model, data = joint_spring_model(arm), fanuc.readings(fanuc.MAPPED)
        doubts = look(model, data)
        assert doubts.sentences == ()
        refuse_unbelievable(doubts, model, data)
