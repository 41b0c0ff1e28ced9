"""Errors on the paper's simulated walk, and the paper's cases beside them."""

import numpy as np
import pytest

from benchmarks.inertial.cubic_steps import CASES, cubic_steps
from benchmarks.stride_paper import errors, printed
from benchmarks.stride_paper.cases import case_findings
from benchmarks.stride_paper.errors import (
    KALMAN,
    KEY_POINTS,
    PHASES,
    PRINTED,
    Study,
    kalman_errors,
    key_point_errors,
    measure,
    settings_of,
)
from mbkf.imu.key_points import NOISY_WEIGHTS, USUAL_WEIGHTS


@pytest.fixture(scope="module")
def study():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(errors, "DELAYS_S", (0.0, 0.05))
        return measure([0])


def test_the_papers_settings_in_its_simulation():
    clean, both = printed.simulated("clean"), printed.simulated("noise and drift", 3)
    assert (clean.weights, both.weights) == (USUAL_WEIGHTS, NOISY_WEIGHTS)
    assert (clean.first, both.first) == (1, 3)
    assert (clean.window, clean.rate_hz, clean.threshold) == (10, 50.0, 1.0)
    assert (clean.still_s, clean.low_pass_hz, clean.zero_velocity) == (0.0, None, False)


def test_data_tips_of_the_figures_agree_with_the_printed_errors():
    for case, last in printed.LAST_POSITION_M.items():
        assert 2.0 - last == pytest.approx(printed.FINAL_M[case], abs=0.01)


def test_the_phase_of_the_windows_decides_for_key_points_and_not_for_the_filter():
    walk = cubic_steps()
    finals = [key_point_errors(walk, settings_of(KEY_POINTS, "clean", first))[0] for first in PHASES]
    assert max(finals) > 1.0
    assert finals[0] < 0.15
    assert max(kalman_errors(cubic_steps(delay_s=delay))[0] for delay in (0.0, 0.05, 0.13)) < 0.03


def test_every_method_case_and_phase_is_measured(study):
    assert set(study.errors) == {(m, c) for m in (PRINTED, KEY_POINTS, KALMAN) for c in CASES}
    assert {len(study.errors[method, case]) for method in (PRINTED, KEY_POINTS) for case in CASES} == {10}
    draws = [study.errors[PRINTED, case].shape[1] for case in CASES]
    assert draws == [1, 1, 8, 8]  # the eight directions of the drift


def test_the_cases_have_their_bounds_a_table_and_verdicts(study):
    found = case_findings(study, 1)
    assert len(found.bands) == 16
    assert all(band.kept for band in found.bands)
    table = found.sheets[0]
    assert [row[1] for row in table.rows] == [0.32, 0.49, 0.47, 0.64, 0.06, 0.14, 0.12, 0.32]
    assert table.rows[0][2] == pytest.approx(1.262, abs=1e-3)  # as printed, the paper's windows
    assert table.rows[0][3] == pytest.approx(0.058, abs=1e-3)  # and aligned ones
    assert [claim.verdict for claim in found.claims[:4]] == ["differs"] * 4
    assert found.claims[5].statement.startswith("Drift raises")
    assert found.claims[5].verdict == "reproduced"


def test_a_value_is_reproduced_where_one_phase_gives_both_numbers():
    found = np.full((10, 1, 2), 5.0)
    found[7, 0] = [0.33, 0.05]
    found[2, 0] = [0.49, 9.0]
    study = Study({(method, case): found for method in (PRINTED, KEY_POINTS, KALMAN) for case in CASES})
    verdicts = [claim.verdict for claim in case_findings(study, 1).claims[:4]]
    assert verdicts == ["reproduced", "differs", "differs", "differs"]


@pytest.mark.parametrize(("larger", "verdict"), [(6, "differs"), (8, "reproduced")])
def test_an_effect_shows_in_most_draws(larger, verdict):
    errors = {
        (method, case): np.ones((10, 10, 2)) for method in (PRINTED, KEY_POINTS, KALMAN) for case in CASES
    }
    errors[PRINTED, "noise"] = np.tile(np.where(np.arange(10) < larger, 2.0, 0.5)[:, None], (10, 1, 2))
    claim = case_findings(Study(errors), 10).claims[4]
    assert claim.statement.startswith("Noise raises")
    assert claim.verdict == verdict
