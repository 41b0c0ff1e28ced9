"""Orientations for OpenSense: quaternions w, x, y, z that turn the bodies of the exported model as its motion does."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.written import form_of
from mbkf.model.osim import to_osim_axes
from mbkf.trial.exchange.result_orientations import orientations_text
from tests.recordings import LOST, broken_walk, walker


@pytest.fixture(scope="module")
def lines():
    return orientations_text(broken_walk(), walker()[1]).splitlines()


def test_the_heading_is_opensense_s(lines, tmp_path):
    head = lines[: lines.index("endheader")]
    assert (
        "DataType=Quaternion" in head
        and f"DataRate={broken_walk().rate_hz:g}" in head
        and "version=3" in head
    )
    names = lines[len(head) + 1].split("\t")
    assert names == ["time", *(f"{segment}_imu" for segment in walker()[1].joints)]
    (tmp_path / "o.sto").write_text("\n".join(lines))
    assert form_of(tmp_path / "o.sto") is not None


def test_every_axis_of_every_segment_points_where_the_result_has_it(lines):
    r, model = broken_walk(), walker()[1]
    rows = [line.split("\t") for line in lines[lines.index("endheader") + 2 :]]
    times = np.array([float(row[0]) for row in rows])
    np.testing.assert_allclose(times, r.times_s[r.tracked], atol=1e-8)
    assert len(rows) == r.frames - (LOST.stop - LOST.start)
    for k in range(0, len(rows), 40):
        quaternions = np.array([[float(one) for one in word.split(",")] for word in rows[k][1:]])
        turned = Rotation.from_quat(quaternions[:, [1, 2, 3, 0]]).as_matrix()
        R, _ = model.placements(r.q[np.flatnonzero(r.tracked)[k]])
        for found, joint in zip(turned, model.joints.values(), strict=True):
            for axis in np.eye(3):  # the body's axis, in OpenSim's axes of body and world
                np.testing.assert_allclose(
                    found @ to_osim_axes(axis), to_osim_axes(R[joint.joint_id] @ axis), atol=1e-10
                )
