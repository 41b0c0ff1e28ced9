"""Random trials: the same by seed, within their bounds, and spoilt as they say."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.campaign.draw import OCCLUSION, PLATES, RATE_HZ, SECONDS, SKIN_M, begun, drawn, spoilt
from tests.walker import walker

SEEDS = range(400)


def test_a_seed_is_always_the_same_trial_and_another_one_another():
    assert drawn(17) == drawn(17)
    assert len({str(drawn(seed)) for seed in SEEDS}) == len(SEEDS)


def test_all_motions_plates_and_faults_occur_within_bounds():
    some = [drawn(seed) for seed in SEEDS]
    assert {one.motion for one in some} == set(SECONDS)
    assert {one.plates for one in some} == set(PLATES)
    assert all(SECONDS[one.motion][0] <= one.seconds <= SECONDS[one.motion][1] for one in some)
    assert {RATE_HZ[0] <= one.rate_hz <= RATE_HZ[1] for one in some} == {True}
    for name, (least, most) in (("skin_sd_m", SKIN_M), ("occlusion", OCCLUSION)):
        values = np.array([getattr(one.errors, name) for one in some])
        assert least <= values.min() < least + 0.05 * most and 0.95 * most < values.max() <= most
    for name in ("exchanges", "drops"):
        assert 0.2 < np.mean([bool(getattr(one, name)) for one in some]) < 0.4


def plain(**changes):
    return replace(drawn(0), **({"plates": "whole", "exchanges": (), "drops": ()} | changes))


def test_a_trial_is_spoilt_as_it_says():
    trial = walker().trial
    rate, positions = trial.markers.rate_hz, trial.markers.positions_m
    np.testing.assert_array_equal(spoilt(trial, plain()).markers.positions_m, positions)
    assert spoilt(trial, plain()).plates == trial.plates
    assert spoilt(trial, plain(plates="missing")).plates == ()
    dropped = spoilt(trial, plain(drops=((0.1, 0.2),))).markers.positions_m
    gone = slice(round(0.1 * rate), round(0.2 * rate))
    assert np.isnan(dropped[gone]).all()
    np.testing.assert_array_equal(np.delete(dropped, gone, axis=0), np.delete(positions, gone, axis=0))
    changed = spoilt(trial, plain(exchanges=((0.1, 0.2),))).markers.positions_m
    other = (changed != positions) & ~(np.isnan(changed) & np.isnan(positions))
    pair = np.flatnonzero(other.any(axis=(0, 2)))
    assert len(pair) == 2
    np.testing.assert_array_equal(changed[gone][:, pair], positions[gone][:, pair[::-1]])
    assert not np.delete(other, gone, axis=0).any()


@pytest.mark.parametrize("at_s", [0.0, 0.123, 1e3])
def test_a_late_plate_keeps_the_times_of_what_it_has(at_s):
    plate = walker().trial.plates[0]
    late = begun(plate, at_s)
    kept = plate.times_s >= at_s
    assert len(late.force_n) == kept.sum()
    np.testing.assert_allclose(late.times_s, plate.times_s[kept], atol=1e-12)
    np.testing.assert_array_equal(late.force_n, plate.force_n[kept])
