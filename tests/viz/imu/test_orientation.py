"""The comparison picture is written and shows both filters."""

import numpy as np
import pytest

from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.viz.imu.orientation import write_comparison
from tests.imu.turning import turning


@pytest.mark.slow
def test_a_picture_of_both_is_written(tmp_path):
    one = turning(3.0).readings()
    first, second = (
        orientations([one], frame="NWU", settings=OrientSettings(method))[0] for method in ("ekf", "madgwick")
    )
    write_comparison(first, second, tmp_path / "both.svg")
    text = (tmp_path / "both.svg").read_text()
    assert "</svg>" in text
    assert len(text) > 20_000
    write_comparison(first, second, tmp_path / "both.png")
    assert (tmp_path / "both.png").read_bytes()[:4] == b"\x89PNG"
    assert np.isfinite(first.euler_rad).all()
