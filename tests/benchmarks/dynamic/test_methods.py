"""What every method is given alike: settings, offsets removed, the search for the best scale, mappers."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.checks import Check
from benchmarks.dynamic.methods import (
    Method,
    best,
    best_on_all,
    best_two,
    dynamic_pair,
    in_parallel,
    in_turn,
    pooled,
    rows_or_failure,
    tared,
)
from mbkf.errors import InvalidInput, MbkfError
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.io.records import Capture
from mbkf.model.protocol import load_protocol
from tests.captures import made_markers, made_plates


def test_a_method_keeps_marker_positions_and_scales_the_kinematic_filter_only():
    settings = Method("kinematic", scale=0.3).settings(without_plates=("1",))
    assert not settings.correct_markers
    assert settings.kinematic.acceleration_scale == 0.3
    assert settings.without_plates == ("1",)
    own = KinematicSettings(gate=9.0)
    assert Method("kinematic", extra={"kinematic": own}).settings().kinematic is own
    assert Method("dynamic", scale=0.3).settings().kinematic == KinematicSettings()


def test_the_pair_of_a_filter_is_causal_and_smoothed():
    causal, smoothed = dynamic_pair("dynamic")
    assert (causal.settings().smooth, smoothed.settings().smooth) == (False, True)
    assert (causal.label, smoothed.label) == ("dynamic", "dynamic, smoothed")


def test_the_offset_of_a_plate_that_is_free_half_the_time_is_removed():
    plate = made_plates()[0]
    loaded = np.arange(len(plate.force_n))[:, None] >= len(plate.force_n) // 2
    offset = np.array([1.0, 2.0, -15.0])
    stored = replace(plate, force_n=np.where(loaded, plate.force_n, 0.0) + offset)
    (found,) = tared(Capture("", made_markers(), (stored,))).plates
    np.testing.assert_allclose(found.force_n, np.where(loaded, plate.force_n, 0.0), atol=1e-9)
    np.testing.assert_allclose(found.offset[:3], offset)
    assert np.isnan(found.centre_of_pressure_m[0]).all()
    assert np.isfinite(found.centre_of_pressure_m[-1]).all()


def test_the_best_scale_ignores_what_diverged():
    scores = {0.1: float("nan"), 0.2: 3.0, 0.4: 1.0, 0.8: 2.0}
    assert best(scores) == 0.4
    assert best_two(scores) == (0.4, 0.8)
    assert best_two({0.4: 1.0}) == (0.4,)
    with pytest.raises(InvalidInput, match="nothing was tried"):
        best({})


def test_the_search_looks_at_all_items_for_the_best_two_only():
    asked = []

    def score(items, scale):
        asked.append((len(items), scale))
        return abs(scale - 2.0) + (1.0 if len(items) == 5 and scale == 2.0 else 0.0)

    assert best_on_all(score, range(5), (1.0, 2.0, 2.5, 9.0), 2) == (2.5, 0.5)
    assert asked == [(2, 1.0), (2, 2.0), (2, 2.5), (2, 9.0), (5, 2.0), (5, 2.5)]


def test_pooling_gives_every_trial_the_same_weight():
    assert pooled([3.0, 4.0]) == pytest.approx(np.sqrt(12.5))
    assert np.isnan(pooled([]))
    assert np.isnan(pooled([1.0, float("nan")]))


def test_workers_return_what_one_process_does_in_the_same_order_and_errors_whatever_they_carry():
    with in_parallel(2) as mapper:
        assert mapper(abs, [-3, 2, -1]) == in_turn(abs, [-3, 2, -1]) == [3, 2, 1]
        with pytest.raises(MbkfError, match="unknown protocol 'nonsense'"):
            mapper(load_protocol, ["nonsense"])


def test_a_method_that_does_not_run_is_one_failed_row():
    def broken():
        raise InvalidInput("no luck")

    (row,) = rows_or_failure("x", broken)
    assert (row.name, row.passed) == ("x does not run: no luck", False)
    fine = [Check("y", 1.0, 2.0, "<=")]
    assert rows_or_failure("x", lambda: fine) is fine
