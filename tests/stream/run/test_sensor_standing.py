"""The beginning of a live run on inertial sensors: standing calibrates them, and the stream goes on from there."""

import json
import threading
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.imu.mount import read_mounts
from mbkf.stream.file_source import FileSource
from mbkf.stream.played import played_sensors
from mbkf.stream.run.sensor_standing import SensorStanding
from tests.worn import worn

STOP = threading.Event()


@pytest.fixture(scope="module")
def person():
    """A person who stands all the time."""
    return worn("stand", 4.0)


def standing(person, folder, readings=None, **options):
    made = played_sensors(readings or person.moving, "person")
    said = []
    start = SensorStanding(FileSource(made, 0.0), "file", person.model, folder, said.append, **options)
    assert start.connect(STOP, 1.0)
    return start, said


def test_two_seconds_of_standing_calibrate_and_the_stream_goes_on(person, tmp_path):
    start, said = standing(person, tmp_path)
    found = start.find(STOP)
    assert found.worn.segments[0] == "pelvis" and set(found.worn.segments) == set(
        one.name for one in person.moving
    )
    assert len(read_mounts(tmp_path / "mounts.toml")) == 8
    assert found.source.connect(0.0).sensors == tuple(one.name for one in person.moving)
    assert found.source.read(1.0).number == 200
    assert found.report["frames"] == 200 and found.report["sensors"]["right_foot"] == "right_foot"
    assert said[0].startswith("stand still for 2 s") and said[-1] == "8 sensors calibrated; move"


def test_only_the_chosen_sensors_are_followed(person, tmp_path):
    start, _ = standing(person, tmp_path, only=["pelvis", "left_thigh", "left_foot"])
    found = start.find(STOP)
    names = [one.name for one in person.moving]
    assert [names[k] for k in found.worn.columns] == list(found.worn.segments)
    assert set(found.worn.segments) == {"pelvis", "left_thigh", "left_foot"}


def test_who_does_not_stand_still_is_told(person, tmp_path):
    shaken = [
        replace(one, angular_velocity_rad_s=one.angular_velocity_rad_s + np.array([0.0, 1.0, 0.0]))
        for one in person.moving
    ]
    start, _ = standing(person, tmp_path, shaken)
    with pytest.raises(InvalidInput, match=r"ended before the person stood still: sensor .* turns at"):
        start.find(STOP)
    told = json.loads((tmp_path / "live.json").read_text())
    assert told["state"] == "not calibrated" and "stood still" in told["ended_by"]


def test_sensors_that_are_no_persons_are_refused_at_once(person, tmp_path):
    with pytest.raises(InvalidInput, match="two sensors sit on pelvis"):
        standing(person, tmp_path, [*person.moving, replace(person.moving[0], name="hips")])
    with pytest.raises(UnknownName, match="nowhere"):
        standing(person, tmp_path, only=["nowhere"])


def test_a_stop_ends_the_waiting(person, tmp_path):
    start, _ = standing(person, tmp_path)
    stop = threading.Event()
    stop.set()
    assert start.find(stop) is None
    assert json.loads((tmp_path / "live.json").read_text())["ended_by"] == "it was stopped"
