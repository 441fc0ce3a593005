"""Labels of poses to measure next go on where those of the round before ended."""

from sk120stiff.measurements.poses import labels_to_come


def test_none_of_them_is_taken() -> None:
    assert labels_to_come(("A", "B"), 2) == ("next_1", "next_2")
    assert labels_to_come(("A", "next_1", "next_8", "next_x"), 2) == ("next_9", "next_10")
    assert labels_to_come((), 0) == ()
