"""Files of foreign persons: names, missing arrays, coordinates and knee moments by name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.foreign.making.capture import write_markers
from benchmarks.foreign.truth import TO_OURS, foreigners
from mbkf.errors import FileFormatError, UnknownName

FRAMES = 5


def folder(path: Path, without: str = "") -> Path:
    """A folder with one person who walks."""
    walk = path / "anna" / "walk"
    walk.mkdir(parents=True)
    (path / "anna" / "person.json").write_text(json.dumps({"mass": 61.5}), encoding="utf-8")
    values = np.arange(2.0 * FRAMES).reshape(FRAMES, 2)
    arrays = {
        "t": 0.01 * np.arange(FRAMES),
        "names": np.array(["hip_flexion_r", "knee_angle_r"]),
        "q": values,
    }
    arrays |= {"tau": 10.0 * values, "mass": np.array(61.5)}
    arrays |= {f"k{axis}_{side}": np.full(FRAMES, 7.0) for axis in ("flex", "add") for side in "rl"}
    arrays.pop(without, None)
    np.savez(walk / "truth.npz", allow_pickle=False, **arrays)
    write_markers(walk / "exact.trc", ("A", "B"), np.arange(6.0 * FRAMES).reshape(FRAMES, 2, 3) / 10.0)
    return path


def test_persons_motions_and_masses(tmp_path: Path) -> None:
    (person,) = foreigners(folder(tmp_path))
    assert (person.name, person.motions, person.mass_kg) == ("anna", ("walk",), 61.5)
    with pytest.raises(UnknownName, match="anna"):
        foreigners(tmp_path, ["bert"])


def test_coordinates_and_moments_by_name(tmp_path: Path) -> None:
    truth = foreigners(folder(tmp_path))[0].truth("walk")
    np.testing.assert_array_equal(truth.coordinate("knee_angle_r"), [1.0, 3.0, 5.0, 7.0, 9.0])
    np.testing.assert_array_equal(truth.moment("hip_flexion_r"), [0.0, 20.0, 40.0, 60.0, 80.0])
    np.testing.assert_array_equal(truth.moment("knee_angle_r"), 7.0)
    assert not truth.has("ankle_angle_r")
    with pytest.raises(UnknownName, match="ankle_angle_r"):
        truth.coordinate("ankle_angle_r")


def test_markers_come_back_in_our_axes(tmp_path: Path) -> None:
    exact = foreigners(folder(tmp_path))[0].truth("walk").exact
    np.testing.assert_allclose(exact.positions_m[0, 1], TO_OURS @ [0.3, 0.4, 0.5], atol=1e-6)


def test_missing_arrays_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="tau"):
        foreigners(folder(tmp_path, without="tau"))[0].truth("walk")
