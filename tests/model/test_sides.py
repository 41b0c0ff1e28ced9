"""Names of the other side."""

import pytest

from mbkf.model.sides import mirrored


@pytest.mark.parametrize(
    ("name", "other"),
    [("right_foot", "left_foot"), ("left_toes", "right_toes"), ("head", "head"), ("right", "right")],
)
def test_mirrored_names(name, other):
    assert mirrored(name) == other
    assert mirrored(other) == name
