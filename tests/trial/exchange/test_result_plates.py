"""Plates and analog channels of a result's C3D file, as ezc3d reads them."""

from dataclasses import replace

import ezc3d
import numpy as np
import pytest

import mbkf
from mbkf.errors import InvalidInput
from mbkf.io.c3d_write import write_c3d
from mbkf.io.contacts import Source
from mbkf.io.records import (
    AnalogChannel,
    AxesSource,
    Capture,
    MarkerTrajectories,
    PlateReadings,
    SampleScaling,
)
from tests.recordings import LOST, PLATE, broken_walk, leaning_walk

PER_FRAME = 10
SKEWED = PLATE[::-1] + np.array([[0.004, 0, 0], [0, 0.003, 0.002], [0, -0.002, 0], [0.001, 0.005, 0]])


def read_back(path):
    """Force, moment about the middle, and centre of pressure (F, S, 3; N, N m, m) of each plate, and the file."""
    found = ezc3d.c3d(str(path), extract_forceplat_data=True)
    plates = found["data"]["platform"]
    return [
        np.stack([p["force"].T, 1e-3 * p["moment"].T, 1e-3 * p["center_of_pressure"].T]) for p in plates
    ], found


def told(found, group, name):
    return found["parameters"][group][name]["value"]


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    """The file of the capture that the leaning walk was made from: a plate, its raw channels and an EMG."""
    r, rng = leaning_walk(), np.random.default_rng(3)
    rate, samples = PER_FRAME * r.rate_hz, PER_FRAME * r.frames
    force = rng.normal(size=(samples, 3)) * [50.0, 50.0, 300.0] + [0.0, 0.0, 900.0]
    counts = np.float64(rng.integers(-(2**15), 2**15, (2, samples)))
    scaling = SampleScaling(float(np.float32(0.0048828)), float(np.float32(0.1)), 3.0)
    analog = tuple(
        AnalogChannel(name, (raw - 3.0) * (scaling.scale * scaling.general), "V", rate, scaling, "raw")
        for name, raw in zip(("Fx1", "EMG tibialis"), counts, strict=True)
    )
    plate = PlateReadings("1", rate, 0.0, SKEWED.mean(axis=0), force, rng.normal(size=(samples, 3)) * 40.0,
                          np.full((samples, 3), np.nan), 20.0, SKEWED)  # fmt: skip
    markers = MarkerTrajectories(r.marker_names[::-1], r.measured_m[:, ::-1], r.rate_hz)
    path = tmp_path_factory.mktemp("trial") / "trial.c3d"
    write_c3d(Capture("", markers, (plate,), analog=analog), path, every_channel=True)
    return path, force, counts


def exported(r, folder, **trial):
    mbkf.export_result(r, "c3d", folder / "out.c3d", **trial)
    return read_back(folder / "out.c3d")


def test_estimated_loads_are_plates_that_ezc3d_computes_again(tmp_path):
    r = replace(broken_walk(), foot_source=(broken_walk().foot_wrench[..., 2] > 0).astype(int))
    plates, found = exported(r, tmp_path)
    assert told(found, "FORCE_PLATFORM", "USED") == [2] and set(told(found, "FORCE_PLATFORM", "TYPE")) == {2}
    assert told(found, "FORCE_PLATFORM", "DESCRIPTIONS") == [
        f"estimated by mbkf: load on {side}_foot" for side in ("right", "left")
    ]
    for k, (force, _, pressure) in enumerate(plates):
        wrench = np.where(r.tracked[:, None], r.foot_wrench[:, k], 0.0)
        assert np.abs(force - wrench[:, :3]).max() < 0.1
        loaded = wrench[:, 2] > 20.0
        assert loaded.any() and not force[LOST].any()
        assert np.abs(pressure - r.foot_cop_m[:, k])[loaded].max() < 1e-4


def test_moments_are_those_of_the_loads(tmp_path):
    r = leaning_walk()
    plates, found = exported(r, tmp_path)
    names = [word.split()[-1] for word in told(found, "FORCE_PLATFORM", "DESCRIPTIONS")]
    assert names == ["right_foot", "left_foot", "pelvis", "right_hand"]
    corners = 1e-3 * told(found, "FORCE_PLATFORM", "CORNERS")
    loads = r.loads
    for k, name in enumerate(names):
        force, moment, _ = plates[k]
        wrench = loads.wrench[:, loads.names.index(name)]
        about_middle = wrench[:, 3:] - np.cross(corners[:, :, k].mean(axis=1), wrench[:, :3])
        np.testing.assert_allclose(moment, about_middle, atol=1e-3)
        np.testing.assert_allclose(force, wrench[:, :3], atol=1e-3)


def test_plates_of_loads_face_up_and_are_as_large_as_their_places(tmp_path):
    r = leaning_walk()
    exported(r, tmp_path)
    capture = mbkf.read_capture(tmp_path / "out.c3d")
    assert (capture.up_axis, capture.axes_source) == ("z", AxesSource.PLATES)
    for k, plate in enumerate(capture.plates[:2]):
        places = r.loads.point_m[r.loads.source[:, k] != 0, k, :2]
        places = places[np.isfinite(places).all(axis=1)]
        np.testing.assert_allclose(plate.corners_m[:, :2].min(axis=0), places.min(axis=0) - 0.2, atol=1e-4)
        np.testing.assert_allclose(plate.corners_m[:, :2].max(axis=0), places.max(axis=0) + 0.2, atol=1e-4)


def test_the_trial_s_plates_and_channels_are_kept_and_unread_loads_stand_beside_them(tmp_path, trial):
    path, measured, counts = trial
    r = replace(leaning_walk(), read_plate_names=("1",))
    plates, found = exported(r, tmp_path, trial=path)
    assert told(found, "FORCE_PLATFORM", "DESCRIPTIONS")[0] == "measured: plate 1, offset removed"
    np.testing.assert_allclose(plates[0][0], mbkf.read_capture(path).plates[0].force_n, atol=0.1)
    assert (
        np.abs(plates[0][0] - measured).max() < 0.1
    )  # the offset is that of an unloaded plate, which this never is
    names = told(found, "ANALOG", "LABELS")
    assert names[:1] == ["Fx1_tared"] and names[-2:] == ["Fx1", "EMG tibialis"]
    assert told(found, "ANALOG", "DESCRIPTIONS")[-1] == "raw"
    theirs = ezc3d.c3d(str(path))["data"]["analogs"][0]
    np.testing.assert_array_equal(found["data"]["analogs"][0, -2:], theirs[-2:])
    assert len(np.unique(theirs[-1])) == len(np.unique(counts[1]))
    left = told(found, "FORCE_PLATFORM", "DESCRIPTIONS").index(
        "estimated by mbkf: load on left_foot, where no plate reads it"
    )
    unread = r.loads.source[:, 1] == Source.ESTIMATED
    force = plates[left][0][::PER_FRAME]
    np.testing.assert_allclose(force, np.where(unread[:, None], r.foot_wrench[:, 1, :3], 0.0), atol=1e-3)
    assert unread.any() and not unread.all()


def test_a_plate_that_the_filter_did_not_read_is_left_out(tmp_path, trial):
    r = replace(leaning_walk(), read_plate_names=("2",))
    _, found = exported(r, tmp_path, trial=trial[0])
    described = told(found, "FORCE_PLATFORM", "DESCRIPTIONS")
    assert described[:2] == [f"estimated by mbkf: load on {side}_foot" for side in ("right", "left")]
    assert told(found, "ANALOG", "LABELS")[-1] == "EMG tibialis"


def test_another_trial_is_refused(tmp_path, trial):
    r = leaning_walk()
    with pytest.raises(InvalidInput, match=r"is not the trial .* its markers lie 1[0-9] mm from"):
        exported(replace(r, measured_m=r.measured_m + 0.01), tmp_path, trial=trial[0])
    with pytest.raises(InvalidInput, match=rf"is not the trial .* it has {r.frames - 100} of these frames"):
        exported(replace(r, times_s=r.times_s + 1.0), tmp_path, trial=trial[0])
    markers = MarkerTrajectories(r.marker_names, r.measured_m[: r.frames // 2], r.rate_hz)
    write_c3d(Capture("", markers), tmp_path / "half.c3d")
    with pytest.raises(InvalidInput, match="is not the trial"):
        exported(r, tmp_path, trial=tmp_path / "half.c3d")
