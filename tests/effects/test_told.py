"""A sentence on an effect, as the values of its parameters have it."""

import pytest

from sk120stiff.effects.gear.hardening import GearHardening
from sk120stiff.explain.findings import sentence_in
from sk120stiff.model import Model
from tests.effects.test_laws import boom


@pytest.mark.parametrize(
    ("names", "values", "word"),
    [
        (("quadratic", "cubic"), (1e-9, 2e-12), "hardens:"),
        (("quadratic", "cubic"), (0.0, -2e-12), "softens:"),
        (
            ("quadratic", "cubic"),
            (1e-9, -2e-12),
            "hardens or softens",
        ),  # by how large the torque is
        (("extra_below_150",), (2e-6,), "hardens:"),
        (("extra_negative",), (-1e-6,), "one sign"),
    ],
)
def test_a_gear_is_said_to_go_the_way_that_its_values_say(names, values, word):
    gear = GearHardening.at(
        boom(), "yaw", GearHardening.options_of(dict.fromkeys(names, "rad/(N*m)"))
    )
    told = dict(zip(names, values, strict=True))
    model = (Model(boom()) + gear).with_public(**{f"{gear.id}.{n}": v for n, v in told.items()})
    assert word in sentence_in(model, gear)
    assert sentence_in(Model(boom()), gear) == gear.sentence()  # of no value it knows nothing
