"""The soles' height over the plates they stand on."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.checks.floor import floor_finding
from mbkf.trial.preparation.markers_alone import Motion
from tests.checked import body, evidence, motion


@pytest.mark.parametrize(("up_mm", "verdict"), [(0.0, "inside"), (50.0, "outside"), (-50.0, "outside")])
def test_soles_above_or_below_a_plate_are_told(up_mm, verdict):
    q = motion("squat").q.copy()
    q[:, 2] += 1e-3 * up_mm
    found = floor_finding(evidence("squat"), body("squat"), Motion(q, motion("squat").v))
    assert found.value == pytest.approx(up_mm, abs=5.0)
    assert found.verdict == verdict
    if up_mm:
        assert ("above" in found.hint) == (up_mm > 0.0)


def test_nobody_on_a_plate_is_not_judged():
    given = evidence("squat")
    unloaded = replace(given, raw=np.zeros_like(given.raw))
    assert floor_finding(unloaded, body("squat"), motion("squat")).verdict == "not judged"
