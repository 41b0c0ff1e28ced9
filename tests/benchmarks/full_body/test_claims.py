"""Verdicts follow the numbers: made-up outcomes turn them."""

from dataclasses import replace

import pytest

from benchmarks.full_body.accuracy import accuracy_findings, lost_by_fdmc
from benchmarks.full_body.claims import survey_claims
from benchmarks.full_body.filters import CAUSAL, DYNAMIC, FCDI, FDMC, FDMC_PER_FRAME, FDMC_PRINTED
from benchmarks.full_body.survey import Survey
from benchmarks.full_body.trials import JUMP, LOST
from benchmarks.thesis_report.contents import CANNOT_BE_HAD
from tests.benchmarks.full_body.conftest import made_survey


def verdicts(found):
    return {(claim.source, claim.statement): claim.verdict for claim in survey_claims(found)}


def verdict(found, words):
    return next(value for (_, statement), value in verdicts(found).items() if words in statement)


def with_number(found, name, number, factor, movement=None):
    return Survey(
        [
            replace(one, scores=replace(one.scores, **{number: factor * getattr(one.scores, number)}))
            if one.filter == name and movement in (None, one.movement)
            else one
            for one in found.outcomes
        ]
    )


def test_every_claim_has_a_source_numbers_and_a_verdict():
    claims = survey_claims(made_survey({}))
    assert len({claim.statement for claim in claims}) == len(claims) >= 20
    for claim in claims:
        assert claim.verdict in ("holds", "partly", "does not hold")
        assert any(digit in claim.measured for digit in "0123456789")
        assert "nan" not in claim.measured


@pytest.mark.parametrize(
    ("words", "number", "holds", "fails"),
    [
        ("reduces the delay of velocities.", "velocity_delay_ms", 0.5, 1.5),
        ("noise into the velocities", "velocity_noise_rad_s", 2.0, 0.5),
        ("less noise than those of FCDI", "torque_noise_nm", 0.5, 2.0),
        ("they are delayed", "torque_delay_ms", 2.0, 0.5),
        ("FDMC and FCDI estimate angles alike", "angle_deg", 1.05, 1.5),
        ("estimates the knee better", "knee_deg", 0.5, 1.2),
    ],
)
def test_a_verdict_turns_with_its_number(words, number, holds, fails):
    same = made_survey({})
    assert verdict(with_number(same, FDMC_PER_FRAME, number, holds), words) == "holds"
    assert verdict(with_number(same, FDMC_PER_FRAME, number, fails), words) == "does not hold"


def test_lost_jumps_decide_on_the_jump():
    words = "most jumps cannot be reconstructed"
    same = made_survey({})
    assert verdict(same, words) == "does not hold"
    assert verdict(with_number(same, FDMC_PRINTED, "angle_deg", 100.0, JUMP), words) == "holds"


def band(found, name):
    return next(one for one in accuracy_findings(found).bands if name in f"{one.row}: {one.name}")


def test_the_jump_is_judged_against_the_better_of_the_others():
    found = made_survey({DYNAMIC: 0.5, FDMC: 0.8})
    assert band(found, "torque").value == pytest.approx(0.5 / 0.8)
    assert band(found, "torque").kept
    assert not band(made_survey({DYNAMIC: 0.7, FDMC: 0.8}), "torque").kept


def test_one_trial_does_not_show_that_a_result_depends_on_the_case():
    words = "depends on the case"
    assert verdict(made_survey({}, persons=1, seeds=1), words) == CANNOT_BE_HAD
    assert verdict(made_survey({}), words) != CANNOT_BE_HAD


def test_the_knee_is_judged_against_fcdi():
    found = with_number(made_survey({}), DYNAMIC, "knee_deg", 0.4, LOST)
    assert band(found, "knee at the worst").value == pytest.approx(0.4)


def test_a_lost_trial_breaks_the_bound():
    found = made_survey({})
    assert all(one.kept for one in accuracy_findings(found).bands if one.row.startswith("divergences"))
    lost = with_number(found, FCDI, "angle_deg", 6.0)
    assert not band(lost, f"trials: {FCDI}").kept
    counted = {
        check.name: check.value for check in lost_by_fdmc(with_number(found, FDMC, "angle_deg", 100.0))
    }
    assert counted["divergences of FDMC ours, of 20 trials"] == 20.0


def test_tables_have_a_row_per_movement_and_filter():
    sheets = {sheet.name: sheet for sheet in accuracy_findings(made_survey({})).sheets}
    assert len(sheets["errors"].rows) == 7 * 8
    assert len(sheets["divergences"].rows) == 8
    assert [row[0] for row in sheets["divergences"].rows][: len(CAUSAL)] == list(CAUSAL)
    assert all(len(row) == len(sheet.columns) for sheet in sheets.values() for row in sheet.rows)
