"""The speed benchmark's structure; how long anything takes is not tested."""

import numpy as np
import pytest

from benchmarks import speed
from benchmarks.checks import Context


def test_a_quick_run_gives_the_bounded_ratios_and_their_parts(tmp_path):
    checks = speed.run(Context(None, tmp_path, quick=True))
    assert [check.name for check in checks if check.bounded] == [
        "kinematic + inverse dynamics step, median",
        "dynamic step, median",
        "dynamic step, 99th percentile",
    ]
    assert {check.unit for check in checks} == {"P", "µs"}
    assert all(check.value > 0 for check in checks)
    whole, filtering, solving = (check.value for check in checks[:3])
    assert whole > max(filtering, solving)


def test_ratios_are_of_medians_of_sums():
    times = speed.Times(
        np.array([1.0, 2.0, 9.0]), {"a": np.array([1.0, 5.0, 2.0]), "b": np.array([3.0, 0.0, 9.0])}
    )
    assert times.in_products("a") == pytest.approx(1.0)
    assert times.in_products("a", "b") == pytest.approx(2.5)


def test_all_frames_but_the_warm_up_are_timed():
    walk = speed.make_walk(speed.QUICK_SECONDS)
    times = speed.time_kinematic(walk)
    assert set(times.parts) == {"filter", "inverse dynamics"}
    for seconds in (times.product, *times.parts.values()):
        assert len(seconds) == len(walk.measured_m) - 1 - speed.WARM_UP_FRAMES
        assert (seconds > 0).all()


def test_the_dynamic_filter_is_timed_over_all_rounds():
    walk = speed.make_walk(speed.QUICK_SECONDS)
    times = speed.time_dynamic(walk, 2)
    assert len(times.product) == 2 * (len(walk.measured_m) - 1) - speed.WARM_UP_FRAMES
    assert times.in_products("filter", percentile=99.0) >= times.in_products("filter") > 0
