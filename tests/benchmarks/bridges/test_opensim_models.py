"""The benchmark of OpenSim's models as bodies: their own motion from a file."""

import numpy as np

from benchmarks.bridges.opensim_models import _model_motion
from mbkf.io.osim import read_osim
from mbkf.io.storage import Table
from tests.osim_mechanisms import COUPLER, joint, mechanism


def test_coordinates_of_a_file_are_turned_into_rad_and_followers_follow(tmp_path):
    joints = (
        joint("FreeJoint", "ground", "root", ("rx", "ry", "rz", "tx", "ty", "tz")),
        joint("PinJoint", "root", "shin", ("knee",)),
        joint("PinJoint", "root", "kneecap", ("patella",)),
    )
    path = tmp_path / "leg.osim"
    path.write_text(mechanism(joints, COUPLER), encoding="utf-8")
    model = read_osim(path)
    at = {one.name: k for k, one in enumerate(model.coordinates)}
    values = np.column_stack([np.rad2deg([-0.4, 0.3]), [0.2, 0.5]])
    q = _model_motion(
        model, Table(("/jointset/knee/knee/value", "ty"), np.array([0.0, 0.1]), values, True, "")
    )
    np.testing.assert_allclose(q[:, at["knee"]], [-0.4, 0.3], atol=1e-12)
    np.testing.assert_allclose(q[:, at["ty"]], [0.2, 0.5], atol=1e-12)
    np.testing.assert_allclose(q[:, at["patella"]], [2.0 * -0.2, 2.0 * 0.15], atol=1e-12)  # knots of SPLINE
    np.testing.assert_allclose(q[:, at["rx"]], 0.1, atol=1e-12)
