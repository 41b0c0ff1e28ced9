"""Expected markers carry H P Hᵀ of those that are asked for."""

import numpy as np

from mbkf.model.human import HumanModel
from mbkf.sensors.marker_prediction import MarkerPrediction
from mbkf.sensors.marker_sensor import MarkerSensor


def test_spread_is_the_covariance_carried_to_the_markers():
    model = HumanModel.scaled()
    sensor = MarkerSensor(model, ["pelvis", "right_foot"], np.array([[0.1, 0.0, 0.0], [0.0, 0.05, 0.0]]))
    root = np.random.default_rng(0).normal(size=(model.nv, model.nv))
    reading = sensor.reading(model.neutral())
    expected = MarkerPrediction(reading, root @ root.T)
    assert np.array_equal(expected.positions_m, sensor.positions(model.neutral()))
    for chosen in ([True, False], [False, True], [True, True]):
        mask = np.array(chosen)
        H = reading.jacobian[mask]
        assert np.allclose(expected.spread(mask), H @ root @ root.T @ H.transpose(0, 2, 1))
