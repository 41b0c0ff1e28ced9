"""Filters by name: which one it is, what it is told, and that a wrong name is refused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.dynamic.plant import SingerPlant
from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.torque.report import TorqueReport
from mbkf.filters.torque.settings import preset
from mbkf.filters.tracking import track
from mbkf.sensors.foot_contact import FootContact
from mbkf.sensors.foot_plates import FootPlates
from mbkf.sensors.markers import MarkerSettings
from mbkf.trial.preparation.filters import FILTERS, tracking_filter
from tests.dynamics import DT
from tests.followed import WHOLE, inputs, made, recording
from tests.plants.damped import Damped

REPORTS = {"kinematic": KinematicReport, "torque": TorqueReport, "dynamic": DynamicReport}
every_filter = pytest.mark.parametrize("name", FILTERS)


def test_there_are_three_filters():
    assert set(FILTERS) == set(REPORTS)


@every_filter
def test_a_name_is_a_filter_of_this_body(name):
    known = inputs()
    found = tracking_filter(name, known)
    assert type(found.report) is REPORTS[name]
    assert found.model is made().model
    assert found.dt_s == DT
    assert found.kalman.sensor is known.sensor
    np.testing.assert_array_equal(found.kalman.noise_m, known.noise_m)


@every_filter
def test_all_wait_as_long_before_they_start_anew(name):
    """The kinematic settings say so, since all are started by that filter."""
    assert (
        tracking_filter(name, inputs(kinematic=KinematicSettings(restart_after_s=0.7))).restart_after_s == 0.7
    )


@every_filter
def test_unobservable_dofs_reach_the_filter(name):
    unobservable = np.zeros(made().model.nv, dtype=bool)
    unobservable[30] = True
    np.testing.assert_array_equal(
        tracking_filter(name, inputs(unobservable=unobservable)).kalman.unobservable, unobservable
    )


def test_settings_reach_their_own_filter():
    known = replace(
        inputs(),
        kinematic=KinematicSettings(acceleration_scale=3.0),
        dynamic=DynamicSettings(markers=MarkerSettings(marker_noise_scale=2.0)),
        torque=preset("FDMC"),
    )
    assert tracking_filter("kinematic", known).kalman.settings.acceleration_scale == 3.0
    dynamic = tracking_filter("dynamic", known).kalman
    assert dynamic.settings is known.dynamic
    np.testing.assert_array_equal(dynamic.noise_m, 2.0 * known.noise_m)
    assert tracking_filter("torque", known).kalman.settings is known.torque


def test_plates_as_inputs_need_plates():
    wanted = replace(preset("FDMC"), plates="inputs")
    found = tracking_filter("torque", replace(inputs(), torque=wanted))
    assert found.kalman.body.loads_given
    with pytest.raises(InvalidInput, match=r'0 plates are read.*plates = "sensors"'):
        tracking_filter("torque", replace(inputs(), torque=wanted, plates=()))


@pytest.mark.parametrize("name", ["torque", "dynamic"])
def test_plates_reach_the_filters_that_read_them(name):
    found = tracking_filter(name, inputs(plates=made().plates[:1]))
    kinds = (FootPlates, FootContact)
    (block,) = (one for one in found.kalman.blocks if isinstance(one, kinds))
    assert len(block.detector.surfaces_m) == 1


def test_a_plant_reaches_the_dynamic_filter_and_the_standard_one_given_changes_nothing():
    """Smoothed, too: the same arrays by the Singer plant, whoever gives it."""
    known = inputs()
    own = tracking_filter("dynamic", known, plant=Damped).kalman.plant
    assert type(own) is Damped
    assert (own.model, own.dt_s, own.layout.nv) == (made().model, DT, made().model.nv)
    found, expected = (
        track(tracking_filter("dynamic", known, plant=plant), recording(), smoothing=WHOLE)
        for plant in (SingerPlant, None)
    )
    np.testing.assert_array_equal(found.q, expected.q)
    np.testing.assert_array_equal(found.torque_sd, expected.torque_sd)


@pytest.mark.parametrize("name", ["kinematic", "torque"])
@pytest.mark.parametrize("own", [{"blocks": []}, {"plant": Damped}])
def test_blocks_and_plants_are_for_the_dynamic_filter(name, own):
    with pytest.raises(InvalidInput, match=f"are for the dynamic filter; the {name} filter"):
        tracking_filter(name, inputs(), **own)


def test_wrong_names_are_refused():
    with pytest.raises(UnknownName, match="unknown filter 'dynamics'; did you mean dynamic"):
        tracking_filter("dynamics", inputs())
    with pytest.raises(UnknownName, match="known are kinematic, torque, dynamic"):
        tracking_filter("", inputs())
