"""Table 4.4's structure; how long anything takes is not tested."""

import numpy as np
import pytest

from benchmarks.dynamic.methods import tared
from benchmarks.full_body import speed
from benchmarks.full_body.filters import DYNAMIC, FCDI, FDMC, FDMC_PRINTED
from mbkf.trial.synth import synthesise

FRAMES, ROUNDS = 12, 2


@pytest.fixture(scope="module")
def measured():
    subject, made = synthesise("stand", seconds=1.0)
    capture = tared(made.trial)
    return speed.time_filters(subject, capture, made.truth.foot_wrench[:FRAMES], ROUNDS)


def timing(step, others, dt_s=0.01):
    """Rounds × frames of a step's seconds, and the same seconds for every other part."""
    step = np.asarray(step, dtype=float)
    seconds = np.repeat(step[:, :, None], len(speed.PARTS), axis=2)
    seconds[:, :, 1:] = np.where(np.isnan(step)[:, :, None], np.nan, others)
    return speed.Timing(seconds, dt_s)


def test_a_disturbed_round_does_not_move_the_parts_but_counts_in_the_factor():
    one = timing([[0.001, 0.003], [0.001, 0.003], [0.9, 0.9]], 0.002)
    assert one.step_s == pytest.approx(0.002)
    assert one.frame_s == pytest.approx(0.002 + 3 * 0.002)
    assert one.real_time == pytest.approx(0.01 / ((0.008 + 1.8) / 6))


def test_frames_that_are_not_followed_count_nowhere():
    one = timing([[np.nan, 0.004, 0.006], [np.nan, 0.004, 0.006]], 0.001)
    assert one.step_s == pytest.approx(0.005)
    assert one.real_time == pytest.approx(2.0)


def test_every_frame_but_the_start_is_timed_for_every_filter(measured):
    assert tuple(measured.timings) == (FCDI, FDMC_PRINTED, FDMC, DYNAMIC)
    for one in measured.timings.values():
        assert one.seconds.shape == (ROUNDS, FRAMES, len(speed.PARTS))
        assert np.isnan(one.seconds[:, 0]).all()
        assert (one.seconds[:, 1:] > 0).all()
        assert one.frame_s == pytest.approx(one.parts_s.sum())


def test_the_table_adds_up(measured):
    sheet = speed.speed_findings(measured).sheets[0]
    parts = [sheet.columns.index(f"{part} (ms)") for part in speed.PARTS]
    whole, step_p, whole_p = map(sheet.columns.index, ("in all (ms)", "step (P)", "in all (P)"))
    for row in sheet.rows:
        assert len(row) == len(sheet.columns)
        assert row[whole] == pytest.approx(sum(row[k] for k in parts))
        assert row[step_p] * measured.product_s == pytest.approx(row[parts[0]] / 1e3)
        assert row[whole_p] / row[step_p] == pytest.approx(row[whole] / row[parts[0]])


def test_the_verdict_follows_the_factors():
    def verdict(kinematic, printed, dynamic):
        factors = {FCDI: kinematic, FDMC_PRINTED: printed, FDMC: printed, DYNAMIC: dynamic}
        timings = {name: timing([[0.01 / factor]], 0.001) for name, factor in factors.items()}
        return speed.speed_findings(speed.Speed(timings, 1e-4, 1)).claims[0].verdict

    assert verdict(3.0, 2.0, 2.0) == "holds"
    assert verdict(2.0, 1.5, 3.0) == "partly"
    assert verdict(2.0, 0.9, 1.5) == "does not hold"


def test_the_bars_are_the_parts(measured):
    drawing = speed.speed_drawing(measured)
    (one,) = drawing.figure.axes
    widths = np.array([bar.get_width() for bar in one.patches]).reshape(len(speed.PARTS), -1)
    np.testing.assert_allclose(
        widths.sum(axis=0), [1e3 * timing.frame_s for timing in measured.timings.values()]
    )
