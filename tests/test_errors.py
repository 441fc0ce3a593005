"""Numbers in sentences."""

import pytest

from sk120stiff.errors import to_one_place

INF = float("inf")


@pytest.mark.parametrize(
    ("error", "values", "said"),
    [
        (0.007945, (-3842.412345,), ["-3842.4123", "0.0079"]),
        (0.0996, (12.3,), ["12.30", "0.10"]),
        (12637.0, (1.4973e6, INF), ["1497000", "inf", "13000"]),
        (2.5e-7, (1.2345e-5, 0.0), ["1.234e-05", "0.000", "0.025e-05"]),
        (1e-300, (3.0,), ["3", "1e-300"]),
        (INF, (3.0,), ["3", "inf"]),
        (None, (-0.0,), ["0"]),
    ],
)
def test_a_value_has_no_fewer_places_than_its_error(error, values, said) -> None:
    assert to_one_place(error, *values) == said
