"""Filters by name: which one it is, what it is told, and that a wrong name is refused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.dynamic.tracking import DynamicTracking
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.tracking import KinematicTracking
from mbkf.filters.torque.settings import preset
from mbkf.filters.torque.tracking import TorqueTracking
from mbkf.pipelines.trial.followers import FILTERS, follower
from mbkf.sensors.foot_contact import FootContact
from mbkf.sensors.foot_plates import FootPlates
from mbkf.sensors.markers import MarkerSettings
from tests.dynamics import DT
from tests.followed import inputs, made

CLASSES = {"kinematic": KinematicTracking, "torque": TorqueTracking, "dynamic": DynamicTracking}
every_filter = pytest.mark.parametrize("name", FILTERS)


def test_there_are_three_filters():
    assert set(FILTERS) == set(CLASSES)


@every_filter
def test_a_name_is_a_filter_of_this_body(name):
    known = inputs()
    found = follower(name, known)
    assert type(found) is CLASSES[name]
    assert found.model is made().model
    assert found.dt_s == DT
    assert found.kalman.sensor is known.sensor
    np.testing.assert_array_equal(found.kalman.noise_m, known.noise_m)


@every_filter
def test_all_wait_as_long_before_they_start_anew(name):
    """The kinematic settings say so, since all are started by that filter."""
    assert follower(name, inputs(kinematic=KinematicSettings(restart_after_s=0.7))).restart_after_s == 0.7


@every_filter
def test_held_dofs_reach_the_filter(name):
    held = np.zeros(made().model.nv, dtype=bool)
    held[30] = True
    np.testing.assert_array_equal(follower(name, inputs(held=held)).kalman.unobservable, held)


def test_settings_reach_their_own_filter():
    known = replace(
        inputs(),
        kinematic=KinematicSettings(acceleration_scale=3.0),
        dynamic=DynamicSettings(markers=MarkerSettings(marker_noise_scale=2.0)),
        torque=preset("FDMC"),
    )
    assert follower("kinematic", known).kalman.settings.acceleration_scale == 3.0
    dynamic = follower("dynamic", known).kalman
    assert dynamic.settings is known.dynamic
    np.testing.assert_array_equal(dynamic.noise_m, 2.0 * known.noise_m)
    assert follower("torque", known).kalman.settings is known.torque


@pytest.mark.parametrize("name", ["torque", "dynamic"])
def test_plates_reach_the_filters_that_read_them(name):
    found = follower(name, inputs(plates=made().plates[:1]))
    kinds = (FootPlates, FootContact)
    (block,) = (one for one in found.kalman.blocks if isinstance(one, kinds))
    assert len(block.detector.surfaces_m) == 1


def test_wrong_names_are_refused():
    with pytest.raises(UnknownName, match="unknown filter 'dynamics'; did you mean dynamic"):
        follower("dynamics", inputs())
    with pytest.raises(UnknownName, match="known are kinematic, torque, dynamic"):
        follower("", inputs())
