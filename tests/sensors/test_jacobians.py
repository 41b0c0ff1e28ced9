"""Contract of every sensor: the Jacobian it states is the derivative of what it reads, along the manifold.

The classes are found by themselves: any class in ``mbkf/sensors/*.py`` with a method ``reading(q)``.
"""

import importlib
import inspect
import pkgutil
from dataclasses import fields

import numpy as np
import pytest

import mbkf.sensors
from tests.motions import assert_near, central_difference, moderate_pose, protocol_sensor, random_model

MAKERS = {"MarkerSensor": lambda model: protocol_sensor(model)[0]}
"""How to make a sensor whose constructor wants more than the model."""

HELD = {"FlexedMarkerSensor"}
"""Sensors whose Jacobian holds a part that moves slowly with the posture; their own tests state what it is."""


def sensor_classes():
    found = {}
    for module in pkgutil.iter_modules(mbkf.sensors.__path__):
        name = f"mbkf.sensors.{module.name}"
        for _, one in inspect.getmembers(importlib.import_module(name), inspect.isclass):
            if one.__module__ == name and reads_a_configuration(one) and one.__name__ not in HELD:
                found[one.__name__] = one
    return found


def reads_a_configuration(one):
    method = getattr(one, "reading", None)
    return callable(method) and list(inspect.signature(method).parameters) == ["self", "q"]


SENSORS = sensor_classes()
each_sensor = pytest.mark.parametrize("name", SENSORS)


def value_of(reading):
    """The one array of a reading that is neither private to it nor its Jacobian or the body's."""
    public = [field.name for field in fields(reading) if not field.name.startswith("_")]
    (name,) = [name for name in public if name not in {"jacobian", "spatial"}]
    return getattr(reading, name)


def made(name, rng):
    model = random_model(rng)
    return MAKERS.get(name, SENSORS[name])(model), model


def test_the_sensors_are_found():
    assert {"MarkerSensor", "PostureSensor"} <= set(SENSORS)


@each_sensor
@pytest.mark.parametrize("seed", range(6))
def test_jacobian_is_the_derivative_of_the_reading(name, seed):
    rng = np.random.default_rng(seed)
    sensor, model = made(name, rng)
    q = moderate_pose(model, rng, spread=1.0)
    reading = sensor.reading(q)
    assert reading.jacobian.shape == (*value_of(reading).shape, model.nv)
    assert_near(reading.jacobian, central_difference(model, lambda at: value_of(sensor.reading(at)), q), 5e-9)


@each_sensor
def test_jacobian_at_the_neutral_posture(name):
    sensor, model = made(name, np.random.default_rng(9))
    q = model.neutral()
    numeric = central_difference(model, lambda at: value_of(sensor.reading(at)), q)
    assert_near(sensor.reading(q).jacobian, numeric, 1e-9)


@each_sensor
def test_reading_leaves_the_configuration_alone_and_repeats(name):
    rng = np.random.default_rng(8)
    sensor, model = made(name, rng)
    q = moderate_pose(model, rng)
    before, first = q.copy(), sensor.reading(q)
    sensor.reading(moderate_pose(model, rng))
    again = sensor.reading(q)
    np.testing.assert_array_equal(q, before)
    np.testing.assert_array_equal(value_of(again), value_of(first))
    np.testing.assert_array_equal(again.jacobian, first.jacobian)
