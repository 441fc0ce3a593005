"""The catalogue is a value that adds, and installed packages may bring effects."""

from __future__ import annotations

import warnings
from importlib.metadata import EntryPoint

import pytest

from sk120stiff.effects import CATALOGUE, Catalogue, Effect, all_effects, effect
from sk120stiff.effects.base import Imposed
from sk120stiff.effects.catalogue import GROUP, OWN, with_installed
from sk120stiff.errors import InputError, ToolkitWarning
from tests.effects.arms import arm
from tests.effects.outside import EVERYTHING, JointCreep, LinkStretch


def test_it_adds_one_effect_or_several_and_stays_as_it_was() -> None:
    assert tuple(CATALOGUE) == OWN and len(CATALOGUE) == len(OWN)
    assert CATALOGUE + LinkStretch + JointCreep == EVERYTHING
    assert CATALOGUE + [LinkStretch, JointCreep] == EVERYTHING
    assert CATALOGUE + Catalogue([LinkStretch, JointCreep]) == EVERYTHING
    assert hash(EVERYTHING) == hash(CATALOGUE + (LinkStretch, JointCreep))
    assert EVERYTHING.names == (*CATALOGUE.names, "link_stretch", "joint_creep")
    assert LinkStretch in EVERYTHING and "link_stretch" in EVERYTHING
    assert LinkStretch not in CATALOGUE and "link_stretch" not in CATALOGUE
    assert EVERYTHING["link_stretch"] is LinkStretch
    assert repr(Catalogue([LinkStretch])) == "Catalogue(link_stretch)"


def test_arguments_in_the_wrong_order_are_told() -> None:
    with pytest.raises(InputError, match="a robot and then its name, not 'joint_tilt' and"):
        effect("joint_tilt", arm("ur5e"))  # type: ignore[arg-type]


def test_a_name_is_looked_up_in_the_catalogue_that_is_given() -> None:
    robot = arm("sk120")
    found = effect(robot, "link_stretch", "link_2_l", catalogue=EVERYTHING)
    assert found == LinkStretch("link_2_l", found.scale) and found.scale == pytest.approx(
        1, abs=0.1
    )
    assert found in all_effects(robot, catalogue=EVERYTHING)
    assert found not in all_effects(robot)
    with pytest.raises(InputError, match="there is no effect 'link_stretch'"):
        effect(robot, "link_stretch", "link_2_l")
    with pytest.raises(InputError, match=r"no effect 'link_strech'.*did you mean 'link_stretch'"):
        EVERYTHING["link_strech"]


def test_a_name_that_is_taken_is_refused_with_both_places() -> None:
    class BaseRocking(LinkStretch):
        name = "base_rocking"

    with pytest.raises(InputError, match="two effects have the name 'base_rocking'") as refused:
        CATALOGUE + BaseRocking
    assert "sk120stiff.effects.foundation.BaseRocking" in refused.value.what
    assert __name__ in refused.value.what


def test_what_is_no_effect_is_refused() -> None:
    with pytest.raises(InputError, match="is no effect"):
        CATALOGUE + (LinkStretch("link_2_l"),)  # an effect at a place, not its class
    with pytest.raises(InputError, match="is no effect"):
        CATALOGUE + dict

    class Unfinished(Imposed):
        """Neither law nor name."""

    with pytest.raises(InputError, match=r"Unfinished lacks .*shifts, says, places, name"):
        CATALOGUE + Unfinished


def installed(value: str, name: str = "mine") -> EntryPoint:
    return EntryPoint(name, value, GROUP)


def test_installed_effects_join_the_catalogue() -> None:
    points = [installed("tests.effects.outside:LinkStretch")]
    with warnings.catch_warnings(action="error"):
        assert with_installed(OWN, points) == (*OWN, LinkStretch)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("no_such_package.effects:Mine", "No module named 'no_such_package'"),
        ("tests.effects.outside:NoSuchEffect", "NoSuchEffect"),
        ("tests.effects.outside:EVERYTHING", "is no effect"),
        ("sk120stiff.effects.foundation:BaseRocking", "two effects have the name 'base_rocking'"),
    ],
)
def test_a_broken_entry_point_is_a_warning_that_names_it(value: str, said: str) -> None:
    points = [installed(value, "broken"), installed("tests.effects.outside:JointCreep")]
    with pytest.warns(ToolkitWarning) as told:
        found = with_installed(OWN, points)
    assert found == (*OWN, JointCreep)  # the others are not lost
    assert len(told) == 1
    message = str(told[0].message)
    assert "'broken'" in message and value in message and said in message


def test_every_effect_says_what_the_program_has_to_know_of_it() -> None:
    """Names of other effects in a trait are names that exist."""
    for kind in CATALOGUE:
        assert issubclass(kind, Effect)
        for twin in kind.twins:
            assert kind.name in CATALOGUE[twin].twins
