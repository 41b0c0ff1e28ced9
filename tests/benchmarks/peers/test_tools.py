"""OpenSim and biorbd move the same body alike, and keep Newton's law; needs the extra `peers` and the captures."""

import numpy as np
import pytest

pytest.importorskip("opensim", reason="OpenSim is not installed; pip install '.[peers]'")
pytest.importorskip("biorbd", reason="biorbd is not installed; pip install '.[peers]'")

from benchmarks.dynamic.captures import SOURCES
from benchmarks.peers import biorbd_tool, opensim_model
from benchmarks.peers.biomod_from_osim import body_of
from benchmarks.peers.biorbd_tool import Motion
from benchmarks.peers.required import biorbd, opensim
from benchmarks.peers.shared import GAIT2354, WALK, Loads
from mbkf.conventions import GRAVITY_M_S2

# SWIG's wrappers lack docstrings' types, and tell so on import.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture(scope="module", params=[WALK, GAIT2354])
def model(request, real_data, tmp_path_factory):
    assert request.param in SOURCES
    return opensim_model.write_model(request.param, real_data, tmp_path_factory.mktemp("models"))


def test_both_place_markers_alike(model):
    """Exactly but for shank and foot: the knee's centre moves in OpenSim, and is the best fixed hinge for biorbd."""
    body, rng = body_of(model), np.random.default_rng(0)
    read, own = opensim().Model(str(model)), biorbd_tool.read(body)
    state = read.initSystem()
    exact, behind_knee = [], []
    for _ in range(5):
        q = np.zeros(len(body.coordinates))
        for k, name in enumerate(body.coordinates):
            coordinate = read.getCoordinateSet().get(name)
            q[k] = rng.uniform(0.0, 0.3) * np.sign(coordinate.getRangeMax() + coordinate.getRangeMin() or 1.0)
            coordinate.setValue(state, float(q[k]), False)
        read.realizePosition(state)
        found = biorbd_tool.markers(own, q[None])[0]
        for marker, place in zip(body.markers, found, strict=True):
            there = read.getMarkerSet().get(marker.name).getLocationInGround(state)
            moves = marker.body.split("_")[0] in {"tibia", "talus", "calcn", "toes", "patella"}
            (behind_knee if moves else exact).append(np.linalg.norm(place - [there.get(i) for i in range(3)]))
    assert max(exact) < 1e-9
    assert max(behind_knee) < 0.015


def test_a_body_at_rest_weighs_what_its_plates_read(model):
    body = body_of(model)
    own, n = biorbd_tool.read(body), len(body.coordinates)
    mass, still = own.mass(), np.zeros((1, n))
    q = np.zeros((1, n))
    centre = own.CoM(biorbd().GeneralizedCoordinates(q[0])).to_array()

    class Standing(Loads):
        def at(self, times_s):
            half = [
                np.array([0.0, 0.5 * mass * GRAVITY_M_S2, 0.0]),
                np.array([centre[0], 0.0, centre[2]]),
                np.zeros(3),
            ]
            return np.array([[half, half]])

    motion = Motion(q, still, still, np.zeros((1, 0, 3)))
    tau = biorbd_tool.inverse_dynamics(own, motion, np.zeros(1), Standing(model, ()))
    np.testing.assert_allclose(tau[0, :6], 0.0, atol=1e-6 * mass * GRAVITY_M_S2)
