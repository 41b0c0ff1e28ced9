"""What a check found: verdicts by spread and bound, and plain data."""

import pytest

from mbkf.errors import InvalidInput
from mbkf.io.findings import Finding, judgement, not_judged


@pytest.mark.parametrize(
    ("value", "sd", "verdict"),
    [
        (1.9, 1.0, "inside"), (-1.9, 1.0, "inside"), (2.1, 1.0, "doubtful"), (-4.9, 1.0, "doubtful"),
        (5.1, 1.0, "outside"), (-5.1, 1.0, "outside"), (5.1, 3.0, "inside"), (6.1, 3.0, "outside"),
    ],
)  # fmt: skip
def test_verdicts_follow_what_noise_explains_and_then_the_bound(value, sd, verdict):
    assert judgement(value, sd, bound=5.0) == verdict


def test_what_is_not_judged_has_no_number():
    found = not_judged("mass", "%", 5.0, "too short")
    assert (found.value, found.expected_sd, found.verdict, found.hint) == (
        None,
        None,
        "not judged",
        "too short",
    )


def test_plain_data_make_the_same_record():
    found = Finding("mass", 1.0, 0.5, "%", 5.0, "inside", "well", 70.0)
    assert Finding(**found.as_table()) == found


def test_a_verdict_that_is_none_is_refused():
    with pytest.raises(InvalidInput, match="maybe"):
        Finding("mass", 1.0, 0.5, "%", 5.0, "maybe")
