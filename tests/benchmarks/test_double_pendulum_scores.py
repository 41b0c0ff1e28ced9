"""How the pendulum's estimates are measured and shown: delays, gaps, bands, sweeps, tables, the page."""

import numpy as np
import pytest

from benchmarks.double_pendulum.drawings import drawings
from benchmarks.double_pendulum.kinematic import KinematicMethod
from benchmarks.double_pendulum.laboratory import Laboratory, Pair
from benchmarks.double_pendulum.sweeps import Sweep, sweep_findings
from benchmarks.double_pendulum.thesis import FCDI, STUDY, STUDY_RECIPE
from benchmarks.double_pendulum.trials import Estimate, Recipe, Scores, rms, score
from benchmarks.dynamic.methods import in_turn
from benchmarks.thesis_report.delay import delay


@pytest.mark.parametrize("lag_s", [-0.013, 0.0, 0.0042, 0.061])
def test_a_shifted_curve_is_late_by_its_shift(lag_s):
    t = np.arange(301) / 100.0
    curve = lambda at: np.stack([np.sin(3.0 * at), np.cos(5.0 * at)], axis=1)  # noqa: E731
    assert delay(t, curve(t), 0.9 * curve(t - lag_s) + 0.01) == pytest.approx(lag_s, abs=5e-4)


def test_rms_of_nothing_is_no_number_and_of_a_breakdown_infinite():
    assert rms(np.array([3.0, -4.0])) == pytest.approx(np.sqrt(12.5))
    assert np.isnan(rms(np.zeros(0)))
    assert np.isinf(rms(np.array([1.0, np.nan])))


def test_gaps_hide_one_bar_and_are_scored():
    recipe = Recipe(lost_bar=2)
    trial = recipe.trial(0)
    assert trial.hidden.sum() == 30
    assert np.isnan(trial.read.markers_m[trial.hidden, 4:]).all()
    assert np.isfinite(trial.read.markers_m[:, :4]).all()
    truth = trial.motion
    off = Estimate(truth.q.copy(), truth.v, truth.efforts.copy(), np.zeros(301))
    off.q[trial.hidden, 3] += 0.2
    off.efforts[115:145, 0] += 7.0
    off.efforts[145:, 0] += 100.0
    found = score(trial, off, lost_bar=2)
    assert found.gap_angle == pytest.approx(0.2)
    assert found.torque_after == pytest.approx(7.0)
    assert np.isnan(score(Recipe().trial(0), off).gap_angle)


def test_seeds_are_reproducible_and_differ():
    one, again, other = (Recipe().trial(seed).read.markers_m for seed in (4, 4, 5))
    np.testing.assert_array_equal(one, again)
    assert np.abs(one - other).max() > 1e-3


def test_the_laboratory_measures_equal_pairs_once():
    stages, calls = [], []

    def mapper(function, items):
        calls.extend(items)
        return in_turn(function, items)

    lab = Laboratory(mapper, 3, False, lambda *told: stages.append(told))
    pair = Pair(STUDY_RECIPE, FCDI)
    first, second = lab.measure("a", [pair, Pair(STUDY_RECIPE, KinematicMethod(STUDY, 10.0))])
    assert second is first
    assert lab.measure("b", [pair])[0] is first
    assert sum(len(task.seeds) for task in calls) == 3
    assert first.torque.shape == (3,)
    trial = STUDY_RECIPE.trial(1)
    assert first.torque[1] == score(trial, FCDI.run(trial)).torque
    assert stages[-1] == ("b", 0, 0)
    assert lab.measure("c", [pair], 2)[0].torque.shape == (2,)


def curve_scores(torque):
    filled = {name: np.array([1.0, 1.0]) for name in Scores.__dataclass_fields__}
    return Scores(**(filled | {"torque": np.array([torque, torque])}))


def u_shaped(best):
    values = np.array([100.0, 300.0, 900.0, 2700.0, 8100.0])
    return Sweep(values, [curve_scores(10.0 + np.log(value / best) ** 2) for value in values])


def test_the_best_covariance_is_the_vertex_in_log_sigma():
    assert u_shaped(640.0).best == pytest.approx(640.0)


def sweeps():
    from benchmarks.double_pendulum.sweeps import Sweeps

    both = {"sin": u_shaped(1000.0), "squat": u_shaped(500.0)}
    return Sweeps(both, both)


def test_a_u_is_not_an_asymptote():
    found = sweep_findings(sweeps())
    assert all(band.kept for band in found.bands)
    assert [claim.verdict for claim in found.claims[:2]] == ["does not hold", "does not hold"]


def test_figures_of_the_thesis_are_all_drawn():
    from benchmarks.double_pendulum.consistency import FRAMES, Consistency

    flat = [Consistency(np.full(FRAMES, 12.0), np.full(FRAMES, 11.0))]
    made = list(drawings(sweeps(), {"a": flat}))
    numbers = [one.number for one in made]
    assert numbers == [f"3.{k}" for k in range(7, 24)] + ["own"]
    assert len({one.file for one in made}) == len(made)
