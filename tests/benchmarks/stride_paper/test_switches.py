"""Why drift worsens the paper's result and not ours."""

import pytest

from benchmarks.stride_paper.errors import DIRECTIONS
from benchmarks.stride_paper.printed import ALIGNED, AS_STUDIED
from benchmarks.stride_paper.switches import (
    BIAS,
    BOTH,
    FORWARDS,
    OURS,
    VELOCITY,
    measure_switches,
    switch_findings,
)


@pytest.fixture(scope="module")
def switched():
    return measure_switches()


def test_all_signs_of_the_constant_are_run():
    assert len(set(DIRECTIONS)) == 8
    assert {abs(one) for direction in DIRECTIONS for one in direction} == {1.0}


@pytest.mark.parametrize("phase", [ALIGNED, AS_STUDIED])
def test_the_error_follows_each_choice(switched, phase):
    by = {one.name: one for one in switched if one.phase == phase}
    assert max(by[OURS].effect_m, by[VELOCITY].effect_m) < 1e-12  # without a bias stride eq. 6 feels no drift
    assert by[BIAS].effect_m == pytest.approx(0.125, abs=0.002)
    assert by[BOTH].effect_m > 2.0 * by[BIAS].effect_m
    assert by[FORWARDS].effect_m > 5.0 * by[BIAS].effect_m
    assert by[BIAS].drift[:, 0].max() > by[BIAS].clean[0] > by[BIAS].drift[:, 0].min()


def test_bounds_table_and_claims(switched):
    found = switch_findings(switched)
    assert all(band.kept for band in found.bands)
    assert len(found.sheets[0].rows) == len(switched)
    verdicts = {claim.source: claim.verdict for claim in found.claims}
    assert verdicts == {
        "Figure 7": "reproduced",
        "stride eq. 3": "reproduced",
        "stride eq. 4": "cannot be had",
    }
