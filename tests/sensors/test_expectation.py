"""Expected markers carry H P Hᵀ of those that are asked for, and P is worked out once at most."""

import numpy as np

from mbkf.model.human import HumanModel
from mbkf.sensors.expectation import MarkerExpectation
from mbkf.sensors.markers import MarkerSensor


def test_spread_is_the_covariance_carried_to_the_markers():
    model = HumanModel.scaled()
    sensor = MarkerSensor(model, ["pelvis", "right_foot"], np.array([[0.1, 0.0, 0.0], [0.0, 0.05, 0.0]]))
    rng = np.random.default_rng(0)
    root = rng.normal(size=(model.nv, model.nv))
    calls = []
    q = model.neutral()

    def covariance():
        calls.append(1)
        return root @ root.T

    expected = MarkerExpectation(sensor.positions(q), lambda: sensor.reading(q), covariance)
    assert np.array_equal(expected.positions_m, sensor.positions(q))
    assert calls == []
    H = sensor.reading(model.neutral()).jacobian
    for chosen in ([True, False], [False, True], [True, True]):
        mask = np.array(chosen)
        assert np.allclose(expected.spread(mask), H[mask] @ root @ root.T @ H[mask].transpose(0, 2, 1))
    assert calls == [1]
