"""A result as MJCF: each key frame holds the result's posture and velocity in MuJoCo."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.trial.exchange.result_mjcf import write_result_mjcf
from tests.recordings import LOST, broken_walk, walk, walker

EVERY = 25


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("mjcf") / "walk.xml"
    write_result_mjcf(broken_walk(), path)
    return mujoco.MjModel.from_xml_path(str(path))


def test_a_key_stands_for_every_frame_in_which_the_body_is_followed(model):
    r = broken_walk()
    assert model.nkey == r.tracked.sum() == r.frames - (LOST.stop - LOST.start)
    np.testing.assert_allclose(model.key_time, r.times_s[r.tracked], atol=1e-8)
    assert model.key(LOST.start).name == f"frame {LOST.stop + 1}"


def test_postures_and_velocities_are_the_result_s(model):
    r, body, data = broken_walk(), walker()[1], mujoco.MjData(model)
    rows = np.flatnonzero(r.tracked)
    for key in range(0, model.nkey, EVERY):
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        t = rows[key]
        sites = np.array([data.site(name).xpos for name in r.marker_names])
        np.testing.assert_allclose(sites, r.predicted_m[t], atol=1e-9)
        momentum = np.zeros(model.nv)
        mujoco.mj_mulM(model, data, momentum, data.qvel)
        energy = 0.5 * r.v[t] @ body.mass_matrix(r.q[t]) @ r.v[t]
        assert 0.5 * momentum @ data.qvel == pytest.approx(energy, rel=1e-8)
        found, own = np.zeros(6), body.joint("right_foot").joint_id
        step = 1e-6
        before, after = (body.placements(body.integrate(r.q[t], s * step * r.v[t])) for s in (-1, 1))
        speed = (after[1][own] - before[1][own]) / (2 * step)
        mujoco.mj_objectVelocity(
            model, data, mujoco.mjtObj.mjOBJ_XBODY, model.body("right_foot").id, found, 0
        )
        np.testing.assert_allclose(found[3:], speed, atol=1e-6)


def test_a_result_without_a_posture_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match="no frame"):
        write_result_mjcf(replace(walk(), tracked=np.zeros(walk().frames, bool)), tmp_path / "x.xml")
