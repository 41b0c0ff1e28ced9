"""The picture of a search: a line of errors for each ζ, the best marked, courses beside their reference."""

import numpy as np
from matplotlib.figure import Figure

from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.orientation_error import OrientationError
from mbkf.imu.tuning import SearchedGains
from mbkf.viz.imu.gain_sweep import draw_courses, draw_errors, write_sweep
from tests.imu.turning import turning

MADE = turning(1.0)
ERROR = OrientationError(0.1, 0.05, 0.02, 100)
FOUND = SearchedGains(
    MadgwickSettings(0.3, 0.01),
    ERROR,
    ((0.1, 0.0, 0.2), (0.3, 0.0, 0.15), (0.3, 0.01, 0.1), (0.1, 0.01, 0.3)),
)


def test_each_zeta_has_a_line_over_beta():
    axes = Figure().subplots()
    draw_errors(axes, FOUND)
    lines = {line.get_label(): line.get_xydata() for line in axes.get_lines()}
    np.testing.assert_allclose(lines["ζ 0.01"], [[0.1, np.degrees(0.3)], [0.3, np.degrees(0.1)]])
    assert axes.get_title(loc="left") == "least at β 0.3, ζ 0.01"


def test_courses_have_the_sign_of_their_reference(tmp_path):
    (course,) = orientations([MADE.readings()], frame="NWU", settings=OrientSettings("madgwick"))
    axes = Figure().subplots()
    draw_courses(axes, -MADE.truth, [("best", course)])
    reference, drawn = (line.get_ydata() for line in axes.get_lines())
    assert np.abs(reference - drawn).max() < 0.1
    write_sweep(FOUND, MADE.truth, [("best", course)], tmp_path / "s.svg")
    assert "</svg>" in (tmp_path / "s.svg").read_text()
