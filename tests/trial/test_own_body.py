"""A body of one's own: a file of pelvis and legs through scaling, every filter, the results' files and the report."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import read_subject, write_subject
from mbkf.model.body_file import load_body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel, reference_body
from mbkf.model.protocol import load_protocol
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from tests.captures import LEGS, MASS_KG, made_capture, only
from tests.recordings import walker

FILE = Path(__file__).resolve().parents[2] / "docs/examples/bodies/legs.toml"
FILTERS = ("kinematic", "dynamic", "torque")
FLEXION = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "knee_angle_l")


def of_legs(frames=60, amplitude_rad=0.06):
    capture = made_capture(frames, amplitude_rad)
    return replace(capture, markers=only(capture.markers, LEGS))


@pytest.fixture(scope="module")
def subject():
    return scale(of_legs(30, 0.0), body=FILE)


def test_markers_of_segments_that_the_body_lacks_are_left_out(subject):
    segments = {segment.name for segment in load_body(FILE).segments}
    assert {marker.segment for marker in subject.markers} == segments
    assert (subject.body, subject.mass_kg) == ("legs", MASS_KG)
    assert list(subject.scale_factors) == list(load_body(FILE).scale_factors)
    assert list(subject.scale_factors.values()) == pytest.approx([1.0] * 11, abs=0.05)


def test_the_subject_carries_the_body(subject, tmp_path):
    write_subject(subject, tmp_path / "s.toml")
    found = read_subject(tmp_path / "s.toml")
    assert found.body_text == FILE.read_text(encoding="utf-8")
    assert reference_body(found).name == "legs"
    assert HumanModel.of(found).nv == 26
    damaged = replace(found, body_text=found.body_text.replace("[roles]", "[rules]"))
    with pytest.raises(FileFormatError, match="body 'legs' in the subject, line 33: unknown entry 'rules'"):
        HumanModel.of(damaged)


@pytest.mark.parametrize("name", FILTERS)
def test_every_filter_follows_the_legs(subject, name):
    trial = of_legs()
    result = reconstruct(trial, subject, settings=ReconstructSettings(filter=name, smooth=False))
    assert result.tracked.all()
    error = np.linalg.norm(result.predicted_m - result.measured_m, axis=2)[10:]
    assert np.sqrt(np.mean(error**2)) < 0.004
    assert np.isfinite(result.moment("knee_angle_r")[result.valid]).all()
    weight = result.foot_wrench[result.valid, :, 2].sum(axis=1)
    assert weight == pytest.approx(MASS_KG * 9.80665, rel=0.05)


def test_from_the_command_line_to_the_report(tmp_path, capsys):
    write_c3d(of_legs(30, 0.0), tmp_path / "static.c3d")
    write_c3d(of_legs(), tmp_path / "trial.c3d")
    own = tmp_path / "elsewhere" / "my_legs.toml"
    own.parent.mkdir()
    own.write_text(FILE.read_text(encoding="utf-8").replace('name = "legs"', 'name = "my legs"'), "utf-8")

    def run(*words):
        assert main([str(word) for word in words]) == 0, capsys.readouterr().err

    run("scale", tmp_path / "static.c3d", "--body", own, "--mass", MASS_KG, "--out", tmp_path / "s.toml")
    own.unlink()
    run("reconstruct", tmp_path / "trial.c3d", "--subject", tmp_path / "s.toml", "--out", tmp_path / "result")
    run("report", tmp_path / "result", "--out", tmp_path / "report.html")
    run("export", tmp_path / "s.toml", "--to", "urdf", "--out", tmp_path / "s.urdf")
    assert read_reconstruction(tmp_path / "result").subject.body == "my legs"
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Knee flexion" in page
    assert "Trunk, head and arms" not in page


def test_a_body_that_cannot_be_used_is_refused(tmp_path):
    with pytest.raises(UnknownName, match="unknown body 'lags'"):
        scale(of_legs(5), body="lags")
    with pytest.raises(FileFormatError, match="cannot be read"):
        scale(of_legs(5), body=tmp_path / "none.toml")
    with pytest.raises(InvalidInput, match="placed on the body 'human18', not on 'legs'"):
        scale(of_legs(5), body=FILE, protocol=load_protocol("reference36"))


@pytest.mark.slow
@pytest.mark.parametrize("name", FILTERS)
def test_leg_angles_of_a_walk_whose_trunk_is_not_modelled(name):
    """The walker has a whole body; what its legs do is found within the skin's movement."""
    person, model, motion = walker()
    made = synthesise_capture(person, motion, CaptureSettings(), seed=1)
    body = load_body(FILE)
    segments = {segment.name for segment in body.segments}
    names = tuple(marker.name for marker in person.markers if marker.segment in segments)
    static, trial = (
        replace(one, markers=one.markers.select(tuple(n for n in one.markers.names if n in names)))
        for one in (made.static, made.trial)
    )
    subject = scale(static, mass_kg=person.mass_kg, body=body)
    result = reconstruct(trial, subject, settings=ReconstructSettings(filter=name, smooth=False))
    clinical = ClinicalAngles(model)
    true = clinical.angles(motion.q)
    for angle in FLEXION:
        error = np.rad2deg(result.angle(angle) - true[:, clinical.names.index(angle)])[result.tracked]
        assert error.std() < 4.0, angle
    moments = clinical.moments(motion.q, motion.tau, true)[:, clinical.names.index("ankle_angle_r")]
    both = result.tracked & result.valid
    assert np.sqrt(np.mean((result.moment("ankle_angle_r") - moments)[both] ** 2)) < 0.05 * np.ptp(moments)


@pytest.mark.slow
def test_a_real_capture_of_the_legs(real_data):
    """Vicon's sample of the CGM 2.4: no marker above the pelvis, one plate."""
    capture = read_capture(real_data / "cgm24_lowerlimb_walk" / "CGM24_Walking01.c3d")
    subject = scale(None, [capture], mass_kg=77.6, height_m=1.70, body=FILE)
    for name in FILTERS:
        result = reconstruct(capture, subject, settings=ReconstructSettings(filter=name, smooth=False))
        assert result.tracked.all()
        error = np.linalg.norm(result.predicted_m - result.measured_m, axis=2)
        assert np.sqrt(np.nanmean(error**2)) < 0.006
        assert 40.0 < np.rad2deg(np.ptp(result.angle("knee_angle_l"))) < 80.0
