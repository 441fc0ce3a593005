"""`sk120stiff effects`: what every effect and its numbers mean."""

from sk120stiff.effects import CATALOGUE


def test_all_effects_with_law_axes_sign_and_unit(run) -> None:
    found = run("effects", "--json").document["effects"]
    assert [each["name"] for each in found] == [kind.name for kind in CATALOGUE]
    for each in found:
        assert each["equation"] and each["axes"]
        for parameter in each["parameters"]:
            assert parameter["meaning"] and parameter["unit"]


def test_one_effect_for_people(run) -> None:
    outcome = run("effects", "force_bias")
    assert outcome.code == 0
    assert "F_reported - F_true = b" in outcome.stdout
    assert "reported minus true force along x of the tool frame" in outcome.stdout
    assert "offset_z" in outcome.stdout


def test_a_name_that_does_not_exist_brings_the_nearest(run) -> None:
    outcome = run("effects", "force_bais")
    assert outcome.code == 2
    assert "did you mean 'force_bias'" in outcome.stderr
