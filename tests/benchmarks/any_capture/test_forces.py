"""The rows of dialects: small where files say the truth, broken where they do not, and never a crash."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.any_capture import forces
from benchmarks.any_capture.dialects import NAMINGS
from benchmarks.checks import Context
from mbkf.errors import FileFormatError
from tests.io.true_capture import made_truth


def rows_of(tmp_path, monkeypatch, true):
    monkeypatch.setattr(forces, "true_walk", lambda: true)
    return {check.name: check for check in forces.forces_rows(Context(None, tmp_path))}


def test_every_dialect_is_a_row_and_passes(tmp_path, monkeypatch):
    rows = rows_of(tmp_path, monkeypatch, made_truth())
    wrenches = [name for name in rows if name.startswith("wrenches")]
    for words in (
        *NAMINGS,
        "promises more rows",
        "Cortex .forces, y up",
        "Cortex .forces, z up",
        "Motive",
        "Qualisys",
    ):
        assert any(words in name for name in wrenches), words
    assert all(check.passed for check in rows.values())


def test_a_refused_file_fails_its_row(tmp_path, monkeypatch):
    def refuse(*_args, **_options):
        raise FileFormatError("a", "broken")

    monkeypatch.setattr(forces, "read_capture", refuse)
    rows = rows_of(tmp_path, monkeypatch, made_truth())
    assert not any(check.passed for check in rows.values())


def test_differences_are_those_that_were_made(tmp_path):
    true = made_truth()
    _, read = next(forces.readings(true, tmp_path))
    assert forces.wrench_difference(true, read) < 1e-9
    plate = read.plates[0]
    more = replace(plate, force_n=1.01 * plate.force_n)
    assert forces.wrench_difference(true, replace(read, plates=(more, read.plates[1]))) >= 0.01 - 1e-9
    assert forces.wrench_difference(true, replace(read, plates=(plate,))) == np.inf
    later = replace(plate, start_time_s=0.1)
    assert forces.wrench_difference(true, replace(read, plates=(later, read.plates[1]))) == np.inf
    moved = replace(read.markers, positions_m=read.markers.positions_m + 0.002)
    assert forces.marker_difference_m(true, replace(read, markers=moved)) == pytest.approx(0.002, abs=1e-6)
    other = replace(read.markers, names=read.markers.names[::-1])
    assert forces.marker_difference_m(true, replace(read, markers=other)) == np.inf


def test_the_true_walk_loads_its_plates():
    true = forces.true_walk()
    assert len(true.plates) >= 2
    assert max(plate.force_n[:, 2].max() for plate in true.plates) > 300.0
    assert np.isnan(true.markers.positions_m).any()
