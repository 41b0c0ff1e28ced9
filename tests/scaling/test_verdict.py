"""Quality of a fitted body: proportions that people do not have, fits that did not converge."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.scaling.verdict import (
    DOUBTFUL_SPREADS,
    IMPOSSIBLE_NOISE,
    IMPOSSIBLE_SPREADS,
    MOVED_M,
    FitQuality,
    as_each_other,
)

SD = 0.06


def factors(spreads, mean=1.0, count=10):
    """Half of them below and half above the mean, so that they spread by so many prior spreads of it."""
    return mean * (1.0 + spreads * SD * np.tile([-1.0, 1.0], count // 2))


def quality(spreads=1.0, mean=1.0, **changes):
    names = ("left_thigh", "head", "right_thigh", "left_shank")
    values = dict(zip(names, factors(spreads, mean, len(names)).tolist(), strict=True))
    return replace(FitQuality(values, (), SD, 0.9, 0.02, converged=True), **changes)


@pytest.mark.parametrize("mean", [0.6, 1.0, 1.3])
@pytest.mark.parametrize("spreads", [0.0, 1.0, 4.0])
def test_the_spread_of_proportions_does_not_depend_on_size(spreads, mean):
    assert quality(spreads, mean).proportion_spread == pytest.approx(spreads)


def test_a_body_of_impossible_proportions_is_refused_however_well_it_fits():
    assert quality(0.99 * IMPOSSIBLE_SPREADS, rms_per_noise=0.1).refusal == ""
    refused = quality(1.01 * IMPOSSIBLE_SPREADS, rms_per_noise=0.1)
    assert "0.73 to 1.27 of the reference body's, proportions that people do not have" in refused.refusal
    assert replace(refused, proportion_sd=2.0 * SD).refusal == ""


@pytest.mark.parametrize(
    ("share", "converged", "refused"), [(1.01, False, True), (1.01, True, False), (0.99, False, False)]
)
def test_a_fit_that_neither_converges_nor_fits_is_refused(share, converged, refused):
    found = quality(0.0, rms_per_noise=share * IMPOSSIBLE_NOISE, converged=converged)
    assert bool(found.refusal) is refused


@pytest.mark.parametrize(
    ("found", "doubts"),
    [
        (quality(), ()),
        (quality(converged=False), ("the fit did not converge",)),
        (quality(rms_per_noise=2.1), ("markers lie 2.1 times",)),
        (quality(rms_per_noise=1.9), ()),
        (quality(share_left_out=0.11), ("11 % of the samples",)),
        (quality(share_left_out=0.09), ()),
        (quality(1.01 * DOUBTFUL_SPREADS), ("proportions are unusual (left thigh 0.85, head 1.15",)),
        (quality(0.99 * DOUBTFUL_SPREADS), ()),
        (quality(at_bound=("left_shank",)), ("proportions are unusual (left shank 1.06",)),
        (quality(converged=False, share_left_out=0.2), ("the fit did not converge", "20 % of the samples")),
    ],
)
def test_every_doubt_is_a_sentence(found, doubts):
    assert len(found.doubts) == len(doubts)
    assert all(line.startswith(start) for line, start in zip(found.doubts, doubts, strict=True))


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
