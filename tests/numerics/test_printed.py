"""Numbers in sentences: only 0 reads as 0, only all as 100 %."""

import pytest

from mbkf.numerics.printed import percent, rounded


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.0, "0 %"), (1.0, "100 %"), (0.25, "25 %"), (0.004, "0.4 %"), (0.0004, "0.04 %"), (0.9996, "99.96 %"),
        (-0.002, "-0.2 %"), (1e-9, "0 %"), (-1e-9, "0 %"), (1.2, "120 %"), (float("nan"), "nan %"),
    ],
)  # fmt: skip
def test_only_nothing_and_all_read_as_0_and_100(share, text):
    assert percent(share) == text


def test_places_hold_as_far_as_they_suffice():
    assert percent(0.1234, 1) == "12.3 %"
    assert percent(0.0002, 1) == "0.02 %"
    assert percent(0.003, signed=True) == "+0.3 %"


def test_a_length_that_is_not_0_does_not_read_as_0():
    assert [rounded(one) for one in (0.0, 0.03, 99.9, -0.2)] == ["0", "0.03", "100", "-0.2"]
    assert rounded(0.04, 1, signed=True) == "+0.04"
