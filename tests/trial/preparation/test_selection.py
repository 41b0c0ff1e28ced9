"""Markers and plates that a reconstruction reads: chosen by name, renamed, hidden in a time window, withheld."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.trial.preparation.selection import hidden_samples, subject_markers, without_plates
from mbkf.trial.preparation.settings import Hidden
from tests.motions import capture_of, random_model, subject_of

RATE_HZ = 10.0


@pytest.fixture(scope="module")
def subject():
    return subject_of(random_model(np.random.default_rng(3)), aliases={"RKNE": ("R.Knee",)})


def trajectories(names, frames=5):
    positions = np.arange(frames * len(names) * 3, dtype=float).reshape(frames, len(names), 3)
    return MarkerTrajectories(tuple(names), positions, RATE_HZ, 0.0)


def test_markers_come_under_the_subjects_names_and_strangers_are_left_out(subject):
    own = [marker.name for marker in subject.markers][:6]
    names = ["stranger", *("R.Knee" if name == "RKNE" else name for name in [*own, "RKNE"])]
    found = subject_markers(trajectories(dict.fromkeys(names)), subject)
    assert set(found.names) == {*own, "RKNE"}
    given = trajectories(dict.fromkeys(names))
    there = given.names.index("R.Knee")
    np.testing.assert_array_equal(
        found.positions_m[:, found.names.index("RKNE")], given.positions_m[:, there]
    )


def test_persons_with_other_names_are_listed(subject):
    names = [f"{who}:M{k}" for who in ("Anna", "Ben") for k in range(7)]
    with pytest.raises(NotObservable, match=r"2 persons: Anna \(7 markers\), Ben .*--person NAME"):
        subject_markers(trajectories(names), subject)


def test_points_without_names_are_to_be_named(subject):
    with pytest.raises(NotObservable, match="name them with 'mbkf label'"):
        subject_markers(trajectories([f"*{k}" for k in range(8)]), subject)


def test_too_few_markers_of_the_subject_are_refused(subject):
    with pytest.raises(NotObservable, match="has 1 of the subject's markers"):
        subject_markers(trajectories(["RKNE", "A", "B"]), subject)


def test_a_time_window_hides_measured_samples_at_both_of_its_ends():
    markers = trajectories(["A", "B"], frames=6)
    positions = markers.positions_m.copy()
    positions[2, 0] = np.nan
    markers = replace(markers, positions_m=positions)
    hidden = hidden_samples(markers, [Hidden(("A",), 0.1, 0.3), Hidden(("B",), 0.5, 9.0)])
    np.testing.assert_array_equal(np.flatnonzero(hidden[:, 0]), [1, 3])
    np.testing.assert_array_equal(np.flatnonzero(hidden[:, 1]), [5])
    with pytest.raises(UnknownName, match="unknown marker 'C'"):
        hidden_samples(markers, [Hidden(("C",), 0.0, 1.0)])
    with pytest.raises(InvalidInput, match="ends before it begins"):
        hidden_samples(markers, [Hidden(("A",), 1.0, 0.0)])


def test_a_withheld_plate_is_left_out_by_its_name():
    nothing = np.zeros((10, 3))
    plates = tuple(
        PlateReadings(name, 100.0, 0.0, np.zeros(3), nothing, nothing, nothing, 20.0) for name in ("1", "2")
    )
    capture = replace(capture_of(("A",), np.zeros((2, 1, 3))), plates=plates)
    assert [plate.name for plate in without_plates(capture, ("1",)).plates] == ["2"]
    assert without_plates(capture, ()).plates == plates
    with pytest.raises(UnknownName, match="unknown plate '3'"):
        without_plates(capture, ("3",))


def test_a_plate_that_the_reader_left_out_may_be_withheld():
    capture = Capture("a.c3d", trajectories(["A"]), plates_left_out={"2": "it is of type 9"})
    assert without_plates(capture, ["2"]).plates == ()
    with pytest.raises(UnknownName, match="unknown plate '3'"):
        without_plates(capture, ["3"])


def test_a_capture_without_markers_is_not_one_without_names(subject):
    with pytest.raises(NotObservable, match=r"holds no markers; export it again"):
        subject_markers(trajectories(()), subject)
    with pytest.raises(NotObservable, match="no marker of the capture has a name"):
        subject_markers(trajectories(("*1", "*2")), subject)
