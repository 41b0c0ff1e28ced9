"""The benchmark of OpenSim models as bodies: a model counts as read if only its side file is missing."""

import pytest

from benchmarks.bridges.opensim_in import _is_read
from tests.osim_mechanisms import CURVE, LINE, joint, mechanism, spatial_transform


@pytest.mark.parametrize(("function", "read"), [(LINE, True), (CURVE, False)])
def test_a_model_is_read_whose_joints_turn_about_fixed_axes(function, read, tmp_path):
    root = joint("FreeJoint", "ground", "root", ("rx", "ry", "rz", "tx", "ty", "tz"))
    knee = joint("CustomJoint", "root", "shin", ("knee",), spatial_transform((("knee", function),), ()))
    (tmp_path / "leg.osim").write_text(mechanism((root, knee), ""), encoding="utf-8")
    assert _is_read(tmp_path / "leg.osim") is read
