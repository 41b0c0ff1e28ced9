"""Conventions by name: signs, and refusals."""

from dataclasses import replace

import pytest

from mbkf.errors import UnknownName
from mbkf.trial.gait.convention import (
    BY_CLINIC,
    BY_MODEL,
    CONVENTIONS,
    convention_of,
    convention_of_result,
)
from tests.recordings import walk


def test_signs_of_the_clinic():
    signs = {name: BY_CLINIC.angle_sign(name) for row in BY_CLINIC.rows for name in row}
    assert {name for name, sign in signs.items() if sign < 0} == {"pelvis_tilt", "pelvis_list"}
    assert BY_CLINIC.moment_sign("hip_adduction") == -1.0 == -BY_CLINIC.moment_sign("lumbar_extension")
    assert BY_MODEL.angle_sign("pelvis_tilt") == 1.0 == BY_MODEL.moment_sign("knee_angle")


def test_names():
    assert [convention_of(name).name for name in CONVENTIONS] == list(CONVENTIONS)
    assert convention_of("clinical", "external") == replace(BY_CLINIC, moments="external")
    assert convention_of_result(walk()) == BY_MODEL
    assert convention_of_result(replace(walk(), settings={"convention": "clinical"})) == BY_CLINIC
    for wrong in (("x",), ("clinical", "x")):
        with pytest.raises(UnknownName, match="x"):
            convention_of(*wrong)
