"""Numbers of a summary from blocks of a result."""

import numpy as np
import pytest

from mbkf.trial.long.numbers import KeyNumbers, Tally
from mbkf.trial.results.summary import summarise
from tests.io.reconstructions import made_up_whole


def test_a_tally_counts_finite_values():
    found = Tally()
    assert (found.mean, found.rms, found.largest) == (None, None, None)
    found.add(np.array([[3.0, np.nan], [np.inf, -1.0]]))
    found.add(np.array([4.0]))
    assert (found.count, found.mean, found.largest) == (3, 2.0, 4.0)
    assert found.rms == pytest.approx(np.sqrt(26.0 / 3.0))


def test_numbers_of_blocks_are_those_of_the_whole():
    whole = made_up_whole(frames=90)
    numbers = KeyNumbers()
    for block in (slice(0, 40), slice(40, 55), slice(55, 90)):
        numbers.add(whole.part(block))
    found, wanted = numbers.summary(whole), summarise(whole)
    assert found.keys() == wanted.keys()
    for key, value in wanted.items():
        assert found[key] == (pytest.approx(value, rel=1e-12) if isinstance(value, float) else value) or key in (
            "marker_rms_mm_by_name", "marker_noise_mm_by_name", "nis", "torque_sd_nm", "torque_sd_offset_nm",
            "torque_sd_varying_nm", "trunk_moments",
        ), key  # fmt: skip
    for key in ("marker_rms_mm_by_name", "torque_sd_nm", "torque_sd_varying_nm", "nis"):
        assert found[key] == pytest.approx(wanted[key], rel=1e-12), key
