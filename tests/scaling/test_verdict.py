"""What a fitted body is worth: proportions that no person has, fits that did not settle."""

import numpy as np
import pytest

from mbkf.scaling.verdict import (
    DOUBTFUL_SPREADS,
    IMPOSSIBLE_NOISE,
    IMPOSSIBLE_SPREADS,
    MOVED_M,
    as_each_other,
    doubts,
    proportion_spreads,
    refusal,
)

SD = 0.06


def factors(spreads, mean=1.0, count=10):
    """Half of them below and half above the mean, so that they spread by so many prior spreads of it."""
    return mean * (1.0 + spreads * SD * np.tile([-1.0, 1.0], count // 2))


@pytest.mark.parametrize("mean", [0.6, 1.0, 1.3])
@pytest.mark.parametrize("spreads", [0.0, 1.0, 4.0])
def test_the_spread_of_proportions_does_not_depend_on_size(spreads, mean):
    assert proportion_spreads(factors(spreads, mean), SD) == pytest.approx(spreads)


def test_a_body_of_impossible_proportions_is_refused_however_well_it_fits():
    assert refusal(factors(0.99 * IMPOSSIBLE_SPREADS), SD, 0.1, settled=True) == ""
    assert "no person is made so" in refusal(factors(1.01 * IMPOSSIBLE_SPREADS), SD, 0.1, settled=True)
    assert refusal(factors(1.01 * IMPOSSIBLE_SPREADS), 2.0 * SD, 0.1, settled=True) == ""


@pytest.mark.parametrize(
    ("share", "settled", "refused"), [(1.01, False, True), (1.01, True, False), (0.99, False, False)]
)
def test_a_fit_that_neither_settles_nor_fits_is_refused(share, settled, refused):
    assert bool(refusal(factors(0.0), SD, share * IMPOSSIBLE_NOISE, settled)) is refused


GOOD = {"rms_per_noise": 0.9, "share_left_out": 0.02, "settled": True, "at_bound": (), "spreads": 1.0}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, ()),
        ({"settled": False}, ("the fit did not settle",)),
        ({"rms_per_noise": 2.1}, ("markers lie 2.1 times",)),
        ({"share_left_out": 0.11}, ("11 % of the samples",)),
        ({"spreads": 1.01 * DOUBTFUL_SPREADS}, ("proportions are unusual (left thigh 0.85, head 1.15",)),
        ({"at_bound": ("left_shank",)}, ("proportions are unusual (left shank 1.06",)),
        ({"settled": False, "share_left_out": 0.2}, ("the fit did not settle", "20 % of the samples")),
    ],
)
def test_every_doubt_is_told(changes, told):
    known = GOOD | changes
    names = ("left_thigh", "head", "right_thigh", "left_shank")
    values = dict(zip(names, factors(known["spreads"], count=4).tolist(), strict=True))
    found = doubts(
        values, known["at_bound"], SD, known["rms_per_noise"], known["share_left_out"], known["settled"]
    )
    assert len(found) == len(told)
    assert all(line.startswith(start) for line, start in zip(found, told, strict=True))


PLACES_M = np.array([[0.03, 0.0, -0.24], [-0.03, 0.0, -0.24], [0.0, 0.05, -0.1], [0.03, 0.0, -0.24]])
SEGMENTS = ("forearm", "forearm", "forearm", "shank")


def test_two_markers_that_sit_where_the_other_should_are_told():
    found = PLACES_M + np.random.default_rng(0).uniform(-0.008, 0.008, PLACES_M.shape)
    assert as_each_other(SEGMENTS, PLACES_M, found) == []
    exchanged = found[[1, 0, 2, 3]]
    assert as_each_other(SEGMENTS, PLACES_M, exchanged) == [(0, 1)]
    assert as_each_other(("forearm", "shank", "forearm", "shank"), PLACES_M, exchanged) == []
    assert (
        as_each_other(
            SEGMENTS, 0.6 * MOVED_M / 0.06 * PLACES_M, 0.6 * MOVED_M / 0.06 * PLACES_M[[1, 0, 2, 3]]
        )
        == []
    )


def test_a_segment_whose_markers_were_all_moved_aside_is_not_told():
    assert as_each_other(SEGMENTS, PLACES_M, PLACES_M + np.array([0.06, 0.06, 0.0])) == []
