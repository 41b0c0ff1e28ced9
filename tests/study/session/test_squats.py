"""Squats: depth by the centre of mass, knees at the lowest, and how the legs share the load."""

import numpy as np
import pytest

from mbkf.study.session.loading import body_path
from mbkf.study.session.squats import repetitions, squat_measures, sunk
from tests.recordings import recorded, walk


def test_measures_of_each_repetition():
    squat = recorded("squat", 5.0, 2)
    path = body_path(squat)
    found, runs = {one.name: one for one in squat_measures(squat)}, repetitions(path)
    assert runs
    depth = sunk(path)
    np.testing.assert_allclose(found["Depth"].values[""], [100.0 * depth[run].max() for run in runs])
    for side in "rl":
        knee = np.rad2deg(squat.angle(f"knee_angle_{side}"))
        lowest = [knee[run[np.argmax(depth[run])]] for run in runs]
        np.testing.assert_allclose(found["Knee flexion at the lowest"].values[side], lowest)
        torque = np.abs(squat.moment(f"knee_angle_{side}")) / squat.subject.mass_kg
        np.testing.assert_allclose(
            found["Greatest knee torque"].values[side], [torque[run].max() for run in runs]
        )
    force = squat.foot_wrench[:, :, 2]
    share = [100.0 * force[run, 0].sum() / force[run].sum() for run in runs]
    assert list(found["Share of the right leg"].values[""]) == pytest.approx(share)


def test_who_walks_does_not_squat():
    assert squat_measures(walk()) == ()
