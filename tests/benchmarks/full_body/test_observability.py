"""The four ranks of the thesis's 4.1.4.2 are rows of the benchmark."""

import pytest

from benchmarks.full_body.observability import observability_findings


@pytest.fixture(scope="module")
def findings():
    return observability_findings()


def test_the_four_ranks_are_those_of_the_thesis(findings):
    values = {band.name: band.value for band in findings.bands}
    assert values == {
        "complete F, a plate under each foot: rank of 166": 166,
        "simplified F, a plate under each foot: rank of 166": 166,
        "F without ∂z̈/∂T_e, a plate under each foot: rank of 166": 116,
        "complete F, no plates: rank of 166": 154,
        "simplified F, no plates: rank of 166": 154,
    }
    assert all(band.kept for band in findings.bands)


def test_a_rank_is_bounded_from_both_sides_in_quick_runs_too(findings):
    checks = [check for band in findings.bands for check in band.checks(quick=True)]
    assert [check.relation for check in checks] == [">=", "<="] * 5
    assert all(check.passed for check in checks)


def test_every_claim_has_its_verdict(findings):
    assert [claim.verdict for claim in findings.claims] == ["holds"] * 3
    assert all(claim.source == "4.1.4.2" for claim in findings.claims)
