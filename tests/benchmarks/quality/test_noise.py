"""Spoilt markers are spoilt as stated, each trial is taken once, and rows of Newton's law keep their bounds."""

import numpy as np

from benchmarks.quality.noise import BURST_M, QUICK, SHOWN, SPOILT, chosen, law_rows, shaken, slid
from mbkf.io.findings import Finding
from mbkf.trial.checks.newton import FORCE, MOMENT

PLACES = np.zeros((1000, 3, 3))


def test_each_trial_is_taken_once():
    whole = chosen(False)
    names, files = {one.name for one in whole}, [one.trial for one in whole if "{made}" not in one.trial]
    assert len(names) == len(whole) and len(set(files)) == len(files)
    assert {"synth_squat", "synth_walk", "synth_jump"} <= names
    assert {*SPOILT, *SHOWN, *QUICK} <= names
    assert {one.name for one in chosen(True)} == set(QUICK)


def test_a_marker_slides_alone_and_stays_there():
    found = slid(PLACES, 1, 0.03)
    assert not found[:, [0, 2]].any() and not found[:300].any()
    np.testing.assert_allclose(found[701:, 1, 2], -0.03, rtol=1e-12)


def test_cameras_are_off_for_a_fifth():
    found = shaken(PLACES)
    off = np.flatnonzero(found.any(axis=(1, 2)))
    assert (off[0], off[-1]) == (400, 599)
    assert abs(found[off].std() / BURST_M - 1.0) < 0.05


def test_wrong_masses_have_to_be_outside():
    def judged(factor):
        value = 2.0 + 40.0 * abs(factor - 1.0)
        return tuple(Finding(name, value, 2.0, "", 9.0, "inside") for name in (FORCE, MOMENT))

    rows = list(law_rows("walk", judged, bounded=True))
    assert len([row for row in rows if row.bounded]) == 3 and all(row.passed for row in rows)
    assert not all(row.passed for row in law_rows("walk", lambda factor: judged(1.0), bounded=True))
    assert list(law_rows("walk", lambda factor: (), bounded=True)) == []
