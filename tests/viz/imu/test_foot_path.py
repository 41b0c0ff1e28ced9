"""The picture of the feet's paths."""

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from mbkf.numerics.runs import runs
from mbkf.trial.inertial.stride import measure_strides
from mbkf.viz.imu.foot_path import foot_path_figure, write_foot_path


@pytest.fixture(scope="module")
def measured():
    noise = {"force_noise_m_s2": 0.05, "rate_noise_rad_s": 0.01}
    left = foot_walk((1.2, 1.3), **noise)
    right = foot_walk((1.2, 1.3), name="right_foot", wait_s=0.55, **(noise | {"seed": 1}))
    return measure_strides([left.readings, right.readings])


def test_paths_heights_and_strides_are_drawn_with_the_rests(measured):
    path, *heights, lengths = foot_path_figure(measured).axes
    assert len(heights) == 2
    for n, (foot, height) in enumerate(zip(measured.feet, heights, strict=True)):
        line, dots = path.lines[2 * n : 2 * n + 2]
        assert np.allclose(line.get_xydata(), foot.position_m[:, :2])
        assert len(dots.get_xdata()) == len(runs(foot.still)) == len(height.patches)
        assert height.get_title("left").startswith(foot.name)
        assert np.allclose(height.lines[0].get_ydata(), 100 * foot.position_m[:, 2])
    assert len(lengths.containers) == sum(len(foot.strides) for foot in measured.feet)


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_the_picture_is_written(measured, tmp_path, suffix):
    file = tmp_path / f"feet.{suffix}"
    write_foot_path(measured, file)
    assert file.stat().st_size > 5000
    assert [found.name for found in tmp_path.iterdir()] == [file.name]
