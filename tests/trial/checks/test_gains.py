"""The gain of one plate against the others', whatever the mass; and what gains explain."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.checks.gains import explained, gain_finding
from tests.checked import amplified, evidence, plates


@pytest.mark.parametrize("mass", [1.0, 1.3])
@pytest.mark.parametrize("gain", [0.9, 1.0, 1.1])
def test_a_plate_that_reads_otherwise_is_found(mass, gain):
    read = plates()
    middle = len(read) // 2
    gains = [gain if p == middle else 1.0 for p in range(len(read))]
    found = gain_finding(evidence(mass=mass, read=amplified(read, gains)))
    assert found.verdict == ("inside" if gain == 1.0 else "outside")
    if gain != 1.0:
        assert found.value == pytest.approx(100.0 * (gain - 1.0), abs=2.0)
        assert f"'{read[middle].name}' reads 10 % {'more' if gain > 1.0 else 'less'}" in found.hint


def test_gains_of_all_are_none_of_one():
    read = plates()
    assert gain_finding(evidence(read=amplified(read, [1.1] * len(read)))).verdict == "inside"


def test_two_feet_that_always_share_tell_no_gain():
    assert gain_finding(evidence("squat")).verdict == "not judged"


def test_gains_explain_plates_and_mass_but_no_seat():
    read = plates("squat")
    assert explained(evidence("squat"))
    assert explained(evidence("squat", mass=1.3))
    assert explained(evidence("squat", read=amplified(read, [1.1, 1.0])))
    given = evidence("squat")
    sits = np.arange(len(given.times_s)) < len(given.times_s) // 2
    assert not explained(replace(given, given=np.where(sits[:, None, None], 0.4, 1.0) * given.given))
    assert not explained(given.restricted(sits & ~sits))
