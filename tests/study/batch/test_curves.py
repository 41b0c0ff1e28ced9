"""Curves over cycles: the reconstruction's own numbers at 0 to 100 %, tidy, each with its standard deviation."""

import os
import subprocess
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pyarrow.parquet as pq
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.capture import read_capture
from mbkf.io.files_read import files_read
from mbkf.io.results_h5 import write_h5
from mbkf.io.subject import read_subject
from mbkf.study.batch.curves import SCHEMA, curves_of, read_curves, write_curves, write_curves_table
from mbkf.trial.gait.convention import BY_CLINIC, CLINICAL
from mbkf.trial.gait.convention_angles import convention_angles
from mbkf.trial.gait.cycles import POINTS, find_gait, over_cycle
from mbkf.trial.gait.events import plain_found
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.studies import walk_folder


@cache
def walked():
    """A walk of two to three cycles."""
    capture, subject = read_capture(walk_folder() / "trial.c3d"), read_subject(walk_folder() / "subject.toml")
    return reconstruct(capture, subject, settings=ReconstructSettings(smooth=False))


@cache
def columns():
    """The table's columns as arrays."""
    return {name: np.array(values) for name, values in curves_of(walked()).to_pydict().items()}


def where(**asked):
    """Columns of the rows in which others have the values asked for."""
    chosen = np.logical_and.reduce([columns()[name] == value for name, value in asked.items()])
    return {name: values[chosen] for name, values in columns().items()}


def cycles():
    """Side, its name, number and the cycle."""
    gait = find_gait(walked())
    assert gait is not None
    return [
        (side, ("right", "left")[side], number, cycle)
        for side in range(2)
        for number, cycle in enumerate(gait.of(side), start=1)
    ]


def test_every_cycle_has_every_curve_at_every_per_cent():
    keys = list(
        zip(*(columns()[name] for name in ("side", "cycle", "quantity", "name", "unit")), strict=True)
    )
    curves = dict.fromkeys(keys)
    assert {key[:2] for key in curves} == {(said, number) for _, said, number, _ in cycles()}
    assert keys == [key for key in curves for _ in range(POINTS)]
    assert len({key[:4] for key in curves}) == len(curves)
    assert columns()["percent"].tolist() == list(range(POINTS)) * len(curves)


@pytest.mark.parametrize(
    "quantity, name, unit",
    [("angle", "knee_angle", "deg"), ("torque", "knee_angle", "N m"), ("power", "ankle_angle", "W"),
     ("reaction", "force_z", "N"), ("angle", "pelvis_tilt", "deg"), ("angle", "pelvis_tx", "m")],
)  # fmt: skip
def test_values_are_the_reconstruction_s(quantity, name, unit):
    r = walked()
    read = {"angle": (r.angle, r.angle_sd), "torque": (r.moment, r.moment_sd), "power": (r.power, r.power_sd)}
    for side, said, number, cycle in cycles():
        own = where(side=said, cycle=number, quantity=quantity, name=name)
        if quantity == "reaction":
            value, sd = r.foot_wrench[:, side, 2], r.foot_wrench_sd[:, side, 2]
        else:
            full = name if name.startswith("pelvis") else name + ("_r", "_l")[side]
            value, sd = (one(full) for one in read[quantity])
        turn = 180.0 / np.pi if unit == "deg" else 1.0
        for column, expected in (("value", value), ("sd", sd)):
            over = turn * over_cycle(r.times_s, expected, cycle)
            np.testing.assert_allclose(own[column].astype(float), over, rtol=1e-6, atol=1e-6)
        assert set(own["unit"]) == {unit} and set(own["duration_s"]) == {cycle.seconds}


def test_a_cycle_has_its_own_side_and_the_trunk():
    names = set(columns()["name"])
    assert not any(name.endswith(("_r", "_l")) for name in names)
    assert {"knee_angle", "hip_flexion", "lumbar_extension", "force_x"} <= names
    assert not set(where(quantity="torque")["name"]) & {"pelvis_tilt", "pelvis_tx"}


def test_a_cycle_counts_as_measured_where_every_frame_of_it_does():
    r = walked()
    for _, said, number, cycle in cycles():
        inside = (r.times_s >= cycle.start_s) & (r.times_s <= cycle.end_s)
        own = where(side=said, cycle=number)
        assert set(own["measured"].tolist()) == {bool(r.measured[inside].all())}
        assert set(own["valid"].tolist()) == {bool(r.valid[inside].all())}


def test_the_file_is_the_table(tmp_path):
    write_curves(walked(), tmp_path / "curves.parquet")
    found = pq.read_table(tmp_path / "curves.parquet")
    assert found.schema.names == SCHEMA.names
    for name, values in columns().items():
        np.testing.assert_array_equal(np.array(found[name].to_pylist()), values)


def test_what_is_written_is_read_and_damage_is_told(tmp_path):
    path = tmp_path / "curves.parquet"
    table = curves_of(walked())
    write_curves_table(table, path)
    assert read_curves(path).equals(table)
    content = bytearray(path.read_bytes())
    content[len(content) // 3] ^= 0xFF
    for damaged in (bytes(content), bytes(content[: len(content) // 2]), b""):
        path.write_bytes(damaged)
        with pytest.raises(FileFormatError, match="delete its folder and run the batch again"):
            read_curves(path)


def test_curves_are_cut_at_events_by_hand():
    told = plain_found(find_gait(walked()).events)
    assert curves_of(walked(), told).equals(curves_of(walked()))
    moved = [replace(event, time_s=event.time_s + 0.02) for event in told]
    gait, table = find_gait(walked(), moved), curves_of(walked(), moved).to_pydict()
    assert list(dict.fromkeys(table["start_s"])) == [
        cycle.start_s for side in range(2) for cycle in gait.of(side)
    ]
    knee = np.rad2deg(over_cycle(walked().times_s, walked().angle("knee_angle_r"), gait.of(0)[0]))
    asked = zip(*(table[name] for name in ("side", "cycle", "quantity", "name", "value")), strict=True)
    own = [value for *key, value in asked if key == ["right", 1, "angle", "knee_angle"]]
    np.testing.assert_allclose(own, knee, rtol=1e-6)
    assert curves_of(walked(), ()).num_rows == 0


def test_curves_have_the_convention_of_the_result():
    r = walked()
    clinical = curves_of(replace(r, settings={**r.settings, "convention": CLINICAL})).to_pydict()
    asked = zip(*(clinical[name] for name in ("side", "cycle", "quantity", "name", "value")), strict=True)
    found = {}
    for *key, value in asked:
        found.setdefault(tuple(key), []).append(value)
    read = convention_angles(r, BY_CLINIC)
    for side, word, number, cycle in cycles():
        moment = -over_cycle(r.times_s, r.moment(f"hip_flexion_{'rl'[side]}"), cycle)
        np.testing.assert_allclose(found[word, number, "torque", "hip_flexion"], moment, rtol=1e-6)
        for name in ("pelvis_tilt", f"foot_progression_{'rl'[side]}"):
            angle = np.rad2deg(over_cycle(r.times_s, read.of(name)[0], cycle))
            own = found[word, number, "angle", name.removesuffix(f"_{'rl'[side]}")]
            np.testing.assert_allclose(own, angle, rtol=1e-5, atol=1e-5)


def test_a_folder_of_any_bytes_holds_curves(tmp_path):
    path = tmp_path / os.fsdecode(b"walk\xff\xe9") / "curves.parquet"
    table = SCHEMA.empty_table()
    write_curves_table(table, path)
    assert read_curves(path).equals(table)
    assert files_read().name_of(path) is None, "a batch replaces its own table"
    write_curves_table(table, path)


def test_curves_are_made_without_pandas(tmp_path):
    """A worker would load it for nothing."""
    write_h5(walked(), tmp_path / "motion.h5")
    program = (
        "import sys; from mbkf.io.results_h5 import read_h5; from mbkf.study.batch.curves import curves_of; "
        "print(len(curves_of(read_h5(sys.argv[1]))), 'pandas' in sys.modules)"
    )
    words = [sys.executable, "-c", program, str(tmp_path / "motion.h5")]
    rows, loaded = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    assert int(rows) == len(curves_of(walked())) and loaded == "False"
