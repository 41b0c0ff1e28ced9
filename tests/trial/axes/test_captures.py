"""Mirrored or misread captures are scaled and reconstructed as the person they show."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.records import AxesSource, Capture
from mbkf.io.subject import read_subject, write_subject
from mbkf.io.turning import turned
from mbkf.model.protocol import load_protocol
from mbkf.trial.axes.captures import (
    checked_for_protocol,
    checked_for_subject,
    corrected_axes,
    find_axes_by_names,
    turned_like_subject,
)
from mbkf.trial.axes.decision import Verdict
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.scale import scale
from tests.captures import MASS_KG, made_capture

MIRROR = np.diag([1.0, -1.0, 1.0])
ON_ITS_BACK = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
PROTOCOL = load_protocol("reference36")


def without_corners(capture: Capture) -> Capture:
    return replace(capture, plates=tuple(replace(plate, corners_m=None) for plate in capture.plates))


STATIC = made_capture(10, 0.0, plates=(), path="static.trc")
TRIAL = without_corners(made_capture(12, path="trial.trc"))


def misread(capture: Capture, turn: np.ndarray = MIRROR) -> Capture:
    return replace(turned(capture, turn, AxesSource.DEFAULT), axes="x,y,z", up_axis="z")


@pytest.fixture(scope="module")
def subject():
    return scale(misread(STATIC), mass_kg=MASS_KG)


def test_scaling_sees_the_person_in_a_mirrored_static_trial(subject):
    plain = scale(STATIC, mass_kg=MASS_KG)
    assert subject.scale_factors == pytest.approx(plain.scale_factors, abs=1e-9)
    assert "axes" not in plain.report
    (told,) = subject.report["axes"]
    assert (told["capture"], told["read"], told["used"]) == ("static.trc", "x,y,z", "x,-y,z")
    assert "mirrored" in told["note"]


@pytest.mark.parametrize("turn", [MIRROR, ON_ITS_BACK])
def test_a_misread_trial_is_followed_as_the_right_one(subject, turn):
    settings = ReconstructSettings(filter="kinematic", smooth=False, correct_markers=False)
    right = reconstruct(TRIAL, subject, settings=settings)
    found = reconstruct(misread(TRIAL, turn), subject, settings=settings)
    yaw = np.array(found.predicted_m[0] - found.predicted_m[0].mean(axis=0))
    np.testing.assert_allclose(
        np.linalg.norm(yaw, axis=1),
        np.linalg.norm(right.predicted_m[0] - right.predicted_m[0].mean(axis=0), axis=1),
        atol=1e-4,
    )
    knee = right.coordinate_names.index("knee_angle_r")
    np.testing.assert_allclose(found.angles[:, knee], right.angles[:, knee], atol=1e-3)
    axes = summarise(found)["axes"]
    assert (axes["source"], axes["mirrored"]) == ("body", bool(np.linalg.det(turn) < 0))
    assert summarise(right)["axes"] == {"up": "z", "forward": "x", "mirrored": False, "source": "made"}
    assert any("--axes=x,y,z keeps them" in one for one in found.warnings)


def test_a_trial_that_cannot_be_right_is_refused(subject):
    floating = replace(misread(TRIAL, np.diag([1.0, -1.0, -1.0])), plates=TRIAL.plates)
    with pytest.raises(InvalidInput, match=r"trial\.trc: .*plates push along -z"):
        checked_for_subject(floating, subject)


def test_a_withheld_plate_is_no_evidence_on_axes(subject):
    """A plate that faces down contradicts the person; the others do not."""
    whole = made_capture(12, path="trial.trc")
    down = replace(whole.plates[0], force_n=-whole.plates[0].force_n, corners_m=None)
    wrong = misread(replace(whole, plates=(down,)), np.eye(3))
    plain = scale(STATIC, mass_kg=MASS_KG)
    with pytest.raises(InvalidInput, match="push along -z"):
        checked_for_subject(wrong, plain)
    assert checked_for_subject(wrong, plain, (down.name,)).plates == wrong.plates


def test_a_capture_without_names_takes_the_axes_of_the_subjects_static(subject, tmp_path):
    write_subject(subject, tmp_path / "subject.toml")
    kept = read_subject(tmp_path / "subject.toml")
    names = tuple(f"*{i}" for i in range(len(TRIAL.markers.names)))
    raw = replace(misread(TRIAL), markers=replace(misread(TRIAL).markers, names=names))
    for found in (turned_like_subject(raw, kept), checked_for_subject(raw, kept)):
        np.testing.assert_allclose(found.markers.positions_m, TRIAL.markers.positions_m)
        np.testing.assert_allclose(found.plates[0].centre_of_pressure_m, TRIAL.plates[0].centre_of_pressure_m)
    for other in (
        replace(raw, axes="x,-z,y"),
        replace(raw, axes_source=AxesSource.GIVEN),
        replace(raw, axes_source=AxesSource.UP_GIVEN),
    ):
        assert turned_like_subject(other, kept) is other


def test_static_and_trial_are_checked_together():
    captures = [misread(STATIC), misread(TRIAL)]
    checked = checked_for_protocol(captures, PROTOCOL)
    np.testing.assert_allclose(checked[1].markers.positions_m, TRIAL.markers.positions_m)
    assert [one["capture"] for one in corrected_axes(captures, checked)] == ["static.trc", "trial.trc"]
    assert corrected_axes([STATIC], checked_for_protocol([STATIC], PROTOCOL)) == []


def test_names_alone_tell_the_axes():
    assert find_axes_by_names(misread(TRIAL)).verdict is Verdict.PUT_RIGHT
    assert find_axes_by_names(TRIAL).verdict is Verdict.RIGHT
