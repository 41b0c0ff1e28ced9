"""`mbkf reconstruct` writes six files with the promised keys: with plates, gaps or a MOT file, and again."""

import json
import math
import re
from dataclasses import replace
from functools import cache, partial

import h5py
import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.cli.reconstruct import parse_hide, settings_line
from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.results import ARRAYS
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.storage import read_storage
from mbkf.io.trc import read_trc
from mbkf.trial.long import choice
from mbkf.trial.preparation.settings import Hidden
from tests.captures import made_capture

pytestmark = pytest.mark.slow

OPENSIM = {"angles.mot", "angles_lab.mot", "torques.sto", "reactions.mot", "markers.trc"}
FILES = {"summary.json", "motion.h5"} | OPENSIM

KEYS = {
    "verdict", "trial", "protocol", "filter", "smoothed", "later_frames", "version", "direction", "progression",
    "mass_kg", "frames", "rate_hz", "duration_s", "markers_ignored", "markers_explained", "names_exchanged", "checks",
    "markers_used", "missing_fraction", "marker_rms_mm", "marker_max_mm", "marker_rms_mm_by_name",
    "residual_force_rms_n", "residual_moment_rms_nm", "residual_force_share",
    "residual_lever_m", "valid_frames", "measured_frames", "contacts", "unexplained", "limb_doubts",
    "plate_force_change_rms_n",
    "plate_moment_change_rms_nm", "torque_peak_nm_per_kg", "torque_sd_nm", "torque_sd_offset_nm",
    "torque_sd_varying_nm", "trunk_moments", "nis_per_dof", "nis", "marker_noise_mm_by_name",
    "step_seconds_median", "step_seconds_p99", "realtime_factor", "hidden_marker_rms_mm",
    "hidden_marker_max_mm", "truth", "axes", "warnings", "settings", "run_id",
}  # fmt: skip
"""Keys of summary.json, as the contract of the command line names them."""

KINEMATIC = ("--filter", "kinematic")
"""For what no filter touches: the quickest."""


@pytest.fixture
def reconstruct(person, tmp_path):
    """Runs the command on a trial of the made person and returns the folder."""

    def run(trial, *words):
        out = tmp_path / "out"
        subject = ["--subject", str(person.subject), "--out", str(out)]
        assert main(["reconstruct", str(trial), *(str(word) for word in words), *subject]) == 0
        return out

    return run


@pytest.fixture
def causal(reconstruct):
    """The same frame by frame, for what smoothing does not touch."""
    return lambda trial, *words: reconstruct(trial, *words, "--causal")


@pytest.fixture(scope="module")
def plain(person, tmp_path_factory):
    """The folder of the trial as each filter follows it, causally; nobody writes there."""

    @cache
    def folder(name="dynamic"):
        out = tmp_path_factory.mktemp(name) / "out"
        words = ["--subject", person.subject, "--filter", name, "--causal", "--out", out]
        assert main(["reconstruct", str(person.trial), *(str(word) for word in words)]) == 0
        return out

    return folder


def refuse_constant(word):
    raise AssertionError(f"{word} in summary.json")


def test_files_keys_and_numbers(person, reconstruct, capsys):
    out = reconstruct(person.trial)
    assert {path.name for path in out.iterdir()} == FILES
    summary = json.loads((out / "summary.json").read_text(), parse_constant=refuse_constant)
    assert set(summary) == KEYS
    assert (summary["trial"], summary["protocol"], summary["filter"]) == ("trial", "reference36", "dynamic")
    assert (summary["frames"], summary["rate_hz"], summary["markers_used"]) == (60, 100.0, 36)
    assert summary["missing_fraction"] == 0.0
    assert 0.1 < summary["marker_rms_mm"] < 2.0
    assert summary["marker_rms_mm"] < summary["marker_max_mm"] < 10.0
    assert len(summary["marker_rms_mm_by_name"]) == 36
    assert summary["valid_frames"] == 60
    assert summary["truth"] is None
    assert summary["hidden_marker_rms_mm"] is None
    assert (summary["smoothed"], summary["settings"]["smooth"], summary["settings"]["lag_ms"]) == (
        True,
        True,
        0.0,
    )
    shown = capsys.readouterr().out
    assert "60 at 100 Hz" in shown
    kind, heading = summary["progression"]["kind"], summary["progression"]["heading_deg"]
    assert f"{kind}, {heading:z.0f}° from the x axis" in shown
    assert shown.splitlines()[-1] == str(out)
    word = summary["verdict"]["overall"]
    assert word in ("use", "look") and shown.splitlines()[0].startswith(f"trial: {word}")


def test_opensim_files_agree_with_the_motion(plain):
    out = plain()
    motion = read_reconstruction(out)
    angles, torques = read_storage(out / "angles.mot"), read_storage(out / "torques.sto")
    assert angles.in_degrees
    column = motion.coordinate_names.index("knee_angle_r")
    np.testing.assert_allclose(angles.column("knee_angle_r"), np.rad2deg(motion.angles[:, column]), atol=1e-8)
    np.testing.assert_allclose(torques.column("knee_angle_r_moment"), motion.moments[:, column], atol=1e-8)
    reactions = read_storage(out / "reactions.mot")
    for side, column in enumerate(("ground_force_r_vy", "ground_force_l_vy")):
        np.testing.assert_allclose(reactions.column(column), motion.foot_wrench[:, side, 2], atol=1e-6)
    markers = read_trc(out / "markers.trc", CaptureOptions()).markers
    np.testing.assert_allclose(markers.positions_m, motion.predicted_m, atol=1e-8)


@pytest.mark.parametrize(("name", "tolerance_n"), [("kinematic", 1e-3), ("dynamic", 1.0)])
def test_reactions_are_the_plates_or_near_them(name, tolerance_n, person, plain):
    """Exactly what was measured after the kinematic filter, an estimate within the plates' noise of the dynamic one."""
    reactions = read_storage(plain(name) / "reactions.mot")
    total = reactions.column("ground_force_r_vy") + reactions.column("ground_force_l_vy")
    plates = sum(plate.force_n[0, 2] for plate in read_c3d(person.trial, CaptureOptions()).plates)
    np.testing.assert_allclose(total, plates, atol=tolerance_n)


@pytest.mark.parametrize("name", ["kinematic", "torque", "dynamic"])
def test_every_filter_writes_the_same_files(name, plain):
    out = plain(name)
    assert {path.name for path in out.iterdir()} == FILES
    summary = read_summary(out)
    assert set(summary) == KEYS
    assert (summary["filter"], summary["smoothed"]) == (name, False)
    assert (summary["plate_force_change_rms_n"] is None) == (name == "kinematic")
    motion = read_reconstruction(out)
    assert (motion.foot_wrench_sd is None, motion.foot_contact is None) == ((name == "kinematic",) * 2)


def assert_told(out, later_frames, shown):
    """Every file says which later frames the estimates know, and the table does."""
    assert read_summary(out)["later_frames"] == read_reconstruction(out).later_frames == later_frames
    with h5py.File(out / "motion.h5") as file:
        assert file.attrs["later_frames"] == later_frames
    for name in OPENSIM - {"markers.trc"}:
        assert read_storage(out / name).header["laterframes"] == later_frames
    assert re.search(rf"later frames\W+{re.escape(later_frames)}\W*$", shown, re.MULTILINE)


@pytest.mark.parametrize("words", [("kinematic", "--smooth"), ("torque",), ("dynamic",)])
def test_every_filter_smooths_with_or_without_the_option_and_says_so(
    words, person, reconstruct, plain, capsys
):
    out = reconstruct(person.trial, "--filter", *words)
    assert_told(out, "smoothed (all later frames known)", capsys.readouterr().out)
    smooth, causal = read_reconstruction(out), read_reconstruction(plain(words[0]))
    assert smooth.smoothed and not causal.smoothed
    assert np.median(smooth.sd_v / causal.sd_v) < 0.9


def test_the_causal_answer_is_told_and_is_that_with_a_lag_of_0(person, reconstruct, plain, capsys):
    causal = read_reconstruction(plain("kinematic"))
    capsys.readouterr()
    out = reconstruct(person.trial, "--filter", "kinematic", "--lag", "0")
    assert_told(out, "causal (as live)", capsys.readouterr().out)
    found = read_reconstruction(out)
    for name in set(ARRAYS) - {"covariance", "step_seconds"}:
        np.testing.assert_array_equal(getattr(found, name), getattr(causal, name), err_msg=name)


def test_a_lag_is_told_and_known_to_the_readings_after_a_frame(person, reconstruct, plain, capsys):
    causal = read_reconstruction(plain())
    capsys.readouterr()
    out = reconstruct(person.trial, "--lag", "60")
    summary, lagged = read_summary(out), read_reconstruction(out)
    assert (summary["smoothed"], summary["settings"]["lag_ms"], lagged.lag_ms) == (False, 60.0, 60.0)
    assert causal.lag_ms == 0.0
    assert_told(out, "fixed lag 60 ms", capsys.readouterr().out)
    assert np.median(lagged.sd_v / causal.sd_v) < 0.99
    assert not np.array_equal(lagged.q, causal.q)


def test_a_second_run_replaces_the_first_and_keeps_other_files(person, causal):
    out = causal(person.trial, "--filter", "kinematic", "--hide", "RASI@0.1:0.3")
    (out / "notes.txt").write_text("mine")
    again = causal(person.trial, "--filter", "kinematic")
    assert {path.name for path in again.iterdir()} == FILES | {"notes.txt"}
    assert read_summary(again)["hidden_marker_rms_mm"] is None
    assert [path.name for path in again.parent.iterdir()] == ["out"]


def test_hidden_markers_are_predicted(person, causal):
    summary = read_summary(
        causal(person.trial, *KINEMATIC, "--hide", "RASI,RELB@0.2:0.4", "--hide", "C7@0:0.1")
    )
    assert summary["missing_fraction"] == pytest.approx((2 * 21 + 11) / (60 * 36))
    assert 0.0 < summary["hidden_marker_rms_mm"] <= summary["hidden_marker_max_mm"] < 20.0


def test_a_long_trial_is_reconstructed_in_pieces_with_all_options(person, causal, capsys, monkeypatch):
    words = ["--without-plate", "1", "--hide", "RASI@0.1:0.2"]
    whole = causal(person.trial, *words)
    numbers = read_summary(whole)
    monkeypatch.setattr(choice, "long_capture", partial(choice.long_capture, longer_than=10))
    out = causal(person.trial, *words)
    assert {path.name for path in out.iterdir()} == {"motion.h5", "summary.json"}
    found, shown = read_summary(out), capsys.readouterr().out
    assert f"mbkf export {out} --to opensim --out DIR" in shown and shown.splitlines()[-1] == str(out)
    for key in (
        "settings",
        "verdict",
        "contacts",
        "valid_frames",
        "markers_used",
        "missing_fraction",
        "axes",
    ):
        assert found[key] == numbers[key], key
    assert found["hidden_marker_rms_mm"] == pytest.approx(numbers["hidden_marker_rms_mm"], rel=1e-9)


def test_withheld_plate(person, causal, plain):
    """The kinematic filter knows what is measured and nothing else."""
    whole = read_reconstruction(plain("kinematic"))
    part = read_reconstruction(causal(person.trial, "--filter", "kinematic", "--without-plate", "2"))
    assert whole.foot_wrench[:, :, 2].min() > 300.0
    assert part.foot_wrench[:, 1].any() == np.False_
    assert whole.valid.all()
    assert part.valid.mean() < 0.8  # only while that foot moves


def test_what_a_withheld_plate_read_is_estimated(person, causal, plain):
    """With a spread that covers what the plate would have read and says that it is badly known."""
    whole = read_reconstruction(plain())
    part = read_reconstruction(causal(person.trial, "--without-plate", "2"))
    right, left = part.foot_wrench[15:, :, 2].T
    np.testing.assert_allclose(right, whole.foot_wrench[15:, 0, 2], atol=1.0)
    assert (np.abs(left - whole.foot_wrench[15:, 1, 2]) < 3 * part.foot_wrench_sd[15:, 1, 2]).all()
    assert (part.foot_contact[15:] == [1, -1]).all()
    assert (part.foot_wrench_sd[15:, 1, 2] > 5 * whole.foot_wrench_sd[15:, 1, 2]).all()
    assert whole.measured.all()
    assert not part.measured[15:].any()


def test_forces_of_another_file(person, causal, plain):
    plates = read_reconstruction(plain("kinematic"))
    out = causal(person.trial_trc, *KINEMATIC, "--forces", person.forces)
    np.testing.assert_allclose(read_reconstruction(out).foot_wrench, plates.foot_wrench, atol=0.05)
    assert read_summary(out)["valid_frames"] == 60


def test_without_forces_the_kinematic_filter_says_nothing_about_torques(person, causal):
    out = causal(person.trial_trc, "--filter", "kinematic")
    summary = json.loads((out / "summary.json").read_text(), parse_constant=refuse_constant)
    assert set(summary) == KEYS
    assert summary["valid_frames"] == 0
    assert summary["residual_force_rms_n"] is None
    assert set(summary["torque_peak_nm_per_kg"].values()) == {None}


def test_without_forces_torques_are_estimated_with_larger_spreads(person, causal, plain):
    """How two feet share the weight is known by where they stand only; residuals need plates."""
    measured, guessed = read_summary(plain()), read_summary(causal(person.trial_trc))
    assert set(guessed) == KEYS
    assert guessed["measured_frames"] == 0
    assert guessed["residual_force_rms_n"] is None
    assert guessed["plate_force_change_rms_n"] is None
    assert None not in guessed["torque_peak_nm_per_kg"].values()
    for joint in ("hip_r", "knee_r", "ankle_l"):
        assert guessed["torque_sd_nm"][joint] > 1.3 * measured["torque_sd_nm"][joint]
    said = " ".join(guessed["warnings"])
    assert "no force plates: reactions are estimated from the motion" in said
    assert "how they share the load is known by where they stand only" in said


def test_kept_markers_are_those_of_the_subject(person, causal):
    summary = read_summary(causal(person.trial, *KINEMATIC, "--keep-markers"))
    assert summary["settings"]["correct_markers"] is False
    assert summary["marker_rms_mm"] < 2.0


def test_other_contacts_are_looked_for_unless_only_the_feet_bear(person, causal, plain):
    """And the folder says so."""
    feet_only = read_summary(causal(person.trial, "--feet-only"))
    assert read_summary(plain())["settings"]["other_contacts"] is True
    assert feet_only["settings"]["other_contacts"] is False


def test_a_result_that_is_not_to_be_used_is_written_and_with_strict_exits_with_3(person, tmp_path, capsys):
    """Plates that read a person of half the mass: the loads are another's, which the first line states."""
    capture = read_c3d(person.trial, CaptureOptions())
    halves = tuple(replace(p, force_n=0.5 * p.force_n, moment_nm=0.5 * p.moment_nm) for p in capture.plates)
    write_c3d(replace(capture, plates=halves), tmp_path / "trial.c3d")
    words = ["reconstruct", str(tmp_path / "trial.c3d"), "--subject", str(person.subject), *KINEMATIC]
    assert main([*words, "--out", str(tmp_path / "lax")]) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert main([*words, "--strict", "--out", str(tmp_path / "strict")]) == 3
    assert first.startswith("trial: do not use: loads of both legs")
    summary = read_summary(tmp_path / "strict")
    assert summary["verdict"]["parts"]["right_leg_loads"] == "do not use"
    assert summary["verdict"]["parts"]["right_leg"] == "use"
    assert summary["valid_frames"] == 0 and summary["measured_frames"] > 0


def test_hide_is_read():
    assert parse_hide("RASI, LASI@0.5:1e0") == Hidden(("RASI", "LASI"), 0.5, 1.0)
    assert math.isclose(parse_hide("A@-1:2").from_s, -1.0)


def test_ignored_markers_stand_in_summary_and_table(causal, tmp_path, capsys):
    made = made_capture(20)
    names = tuple(n if i < 30 else f"X{i}" for i, n in enumerate(made.markers.names))
    write_c3d(replace(made, markers=replace(made.markers, names=names)), tmp_path / "mixed.c3d")
    summary = json.loads((causal(tmp_path / "mixed.c3d", *KINEMATIC) / "summary.json").read_text())
    assert list(summary["markers_ignored"]) == [f"X{i}" for i in range(30, 36)]
    assert (summary["markers_used"], summary["markers_explained"]) == (30, pytest.approx(30 / 36))
    assert "X30, X31, X32, X33, X34, X35" in " ".join(capsys.readouterr().out.split())


def test_the_settings_of_a_result_are_named():
    assert settings_line({"preset": "", "given": {}}) == settings_line({}) == ""
    assert settings_line({"preset": "FD", "given": {"integrator": "HE"}}) == "preset FD, integrator = HE"
