"""Settings of a reconstruction: which later frames count."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.trial.preparation.settings import ReconstructSettings, recorded


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"lag_s": -0.01}, "not possible: give"),
        ({"lag_s": np.nan}, "not possible: give"),
        ({"lag_s": 0.06, "smooth": True}, "choose one"),
    ],
)
def test_a_lag_is_a_time_and_stands_alone(settings, why):
    with pytest.raises(InvalidInput, match=why):
        ReconstructSettings(**settings)


@pytest.mark.parametrize(
    ("settings", "smooths"),
    [
        ({}, True),
        ({"smooth": True}, True),
        ({"smooth": False}, False),
        ({"lag_s": 0.06}, False),
        ({"lag_s": 0.06, "smooth": False}, False),
    ],
)
def test_later_frames_are_used_unless_a_lag_or_the_causal_answer_is_asked_for(settings, smooths):
    chosen = ReconstructSettings(**settings)
    assert chosen.smooths is recorded(chosen)["smooth"] is smooths


def test_spreads_of_something_else_are_refused():
    assert ReconstructSettings().spreads == ("torques", "angles")
    assert recorded(ReconstructSettings(spreads=()))["spreads"] == ()
    with pytest.raises(InvalidInput, match="choose among torques, angles"):
        ReconstructSettings(spreads=("torques", "forces"))
