"""A limb in doubt in words."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.limb_doubts import LimbDoubt

BAD = LimbDoubt("left_thigh", "fits badly", 1.2, 1.5, "left_shank", np.radians(30.0), 0.031, 0.005)


def test_evidence_and_remedy_of_a_limb_that_stays_in_doubt():
    assert BAD.sentence == (
        "the left thigh was in doubt from 1.20 to 1.50 s: its markers lie 31 mm (RMS) from the body, the left shank is "
        "30° beyond its range; no better pose was found: check the names of its markers and the subject file"
    )


def test_a_limb_within_its_ranges_is_not_said_to_lie_beyond_them():
    found = LimbDoubt("left_thigh", "turned over", 0.0, 0.1, misfit_m=0.02, mended=True).sentence
    assert "beyond" not in found
    assert found.endswith("the limb was fitted anew from there on")


def test_names_put_right_are_listed():
    found = LimbDoubt(
        "left_thigh", "names exchanged", 0.0, 0.1, mended=True, exchanged=(("A", "C"), ("B", "D"))
    ).sentence
    assert found.endswith("the names of A and C, B and D were exchanged and are put right from there on")


def test_an_unknown_kind_is_refused():
    with pytest.raises(InvalidInput, match="unknown kind 'ghost'"):
        LimbDoubt("left_thigh", "ghost", 0.0, 0.1)


def test_a_doubt_comes_back_from_its_text():
    mended = LimbDoubt("left_thigh", "names exchanged", 0.0, 0.1, mended=True, exchanged=(("A", "C"),))
    for one in (BAD, mended):
        assert LimbDoubt.of_text(one.as_text()) == one


@pytest.mark.parametrize("text", ["", "[1]", "{}", '{"limb": "x", "exchanged": []}', '{"exchanged": [3]}'])
def test_a_damaged_text_is_refused(text):
    with pytest.raises(InvalidInput, match="doubt about a limb"):
        LimbDoubt.of_text(text)
