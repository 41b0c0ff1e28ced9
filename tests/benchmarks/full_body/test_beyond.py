"""Statements out of reach are listed with a reason, and none of them is listed as measured, too."""

from benchmarks.full_body.beyond import claims_beyond_reach
from benchmarks.thesis_report.contents import CANNOT_BE_HAD


def test_every_statement_has_a_reason_and_stands_once():
    claims = claims_beyond_reach()
    assert len({claim.statement for claim in claims}) == len(claims)
    for claim in claims:
        assert claim.verdict == CANNOT_BE_HAD
        assert claim.source and claim.measured
