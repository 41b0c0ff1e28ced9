"""Bad input gets one line that says what, where and what to do, exit code 2, and nothing half-written."""

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.c3d_write import write_c3d
from mbkf.io.storage import Table, read_storage, write_storage
from mbkf.io.trc import write_trc
from tests.captures import RATE_HZ, made_capture, made_markers, made_plates, only, snapshot
from tests.io.c3d_builder import Plate, build_c3d

MM = 1000.0


@pytest.fixture
def refused(tmp_path, capsys):
    """Checks that a call ends as bad input must, and leaves the folder as it was."""

    def check(words, *fragments):
        before = snapshot(tmp_path)
        try:
            code = main([str(word) for word in words])
        except SystemExit as end:
            code = end.code
        shown = capsys.readouterr()
        assert (code, shown.out) == (2, ""), shown.err
        assert shown.err.count("\n") == 1
        assert shown.err.startswith("mbkf")
        for fragment in fragments:
            assert str(fragment) in shown.err
        assert snapshot(tmp_path) == before

    return check


@pytest.fixture
def everywhere(person, tmp_path, refused):
    """A bad capture is refused alike by each command that reads it."""

    def check(path, *fragments):
        refused(["info", path], *fragments)
        refused(["scale", path, "--mass", "75", "--out", tmp_path / "s.toml"], *fragments)
        refused(["scale", person.static, "--trial", path, "--mass", "75", "--out", tmp_path / "s.toml"], *fragments)
        refused(["reconstruct", path, "--subject", person.subject, "--out", tmp_path / "out"], *fragments)

    return check


@pytest.fixture
def scale(tmp_path, refused):
    return lambda words, *fragments: refused(["scale", *words, "--out", tmp_path / "s.toml"], *fragments)


@pytest.fixture
def reconstruct(person, tmp_path, refused):
    """`mbkf reconstruct` of a trial, with the made person unless the words name another."""

    def check(words, *fragments):
        subject = [] if "--subject" in words else ["--subject", person.subject]
        refused(["reconstruct", *words, *subject, "--out", tmp_path / "out"], *fragments)

    return check


@pytest.mark.parametrize("suffix", ["c3d", "trc"])
def test_missing_file(suffix, tmp_path, everywhere):
    path = tmp_path / f"none.{suffix}"
    everywhere(path, path, "no such file", f"name a {suffix.upper()} file")


@pytest.mark.parametrize("suffix", ["c3d", "trc"])
def test_folder_instead_of_a_file(suffix, tmp_path, everywhere):
    path = tmp_path / f"folder.{suffix}"
    path.mkdir()
    everywhere(path, path, f"name a {suffix.upper()} file")


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04" * 400], ids=["empty", "text", "zip"])
def test_not_a_c3d(content, tmp_path, everywhere):
    path = tmp_path / "a.c3d"
    path.write_bytes(content)
    everywhere(path, path, "export it")


def test_not_a_trc(tmp_path, everywhere):
    path = tmp_path / "a.trc"
    path.write_text("a,b\n1,2\n")
    everywhere(path, path, "line 1", "not a TRC file", "PathFileType")


def test_other_kinds_of_file(tmp_path, everywhere):
    path = tmp_path / "a.csv"
    path.write_text("a,b\n1,2\n")
    everywhere(path, path, "'.csv' files cannot be read", ".c3d or .trc")


@pytest.mark.parametrize("share", [0.001, 0.1, 0.5, 0.99])
def test_truncated_c3d(share, person, tmp_path, everywhere):
    content = person.trial.read_bytes()
    path = tmp_path / "cut.c3d"
    path.write_bytes(content[: int(share * len(content))])
    everywhere(path, path, "export it")


def test_truncated_trc(person, tmp_path, everywhere):
    lines = person.trial_trc.read_text().splitlines(keepends=True)
    path = tmp_path / "cut.trc"
    path.write_text("".join(lines[:40]))
    everywhere(path, path, "cut short", "60 frames", "copy or export it again")


def test_no_markers_of_the_protocol(person, tmp_path, scale, reconstruct):
    markers = made_markers(20)
    path = tmp_path / "strange.c3d"
    write_c3d(made_capture(20, markers=replace(markers, names=tuple(f"P{i}" for i in range(36)))), path)
    scale([path, "--mass", "75"], "P0, P1", "--protocol")
    scale([path, "--mass", "75", "--protocol", "reference36"], "0 markers", "reference36", "P0, P1", "--protocol")
    reconstruct([path], "0 of the subject's markers", "reference36", "P0, P1")


def test_too_few_markers_to_follow_any_body(tmp_path, scale, reconstruct):
    markers = made_markers(20)
    path = tmp_path / "few.c3d"
    write_c3d(made_capture(20, markers=markers.select(markers.names[:5])), path)
    scale([path, "--mass", "75"], "markers", "--protocol")
    scale([path, "--mass", "75", "--protocol", "reference36"], "5 markers", "--protocol")
    reconstruct([path], "5 of the subject's markers", "at least 6")


def test_markers_that_are_never_seen_together(tmp_path, scale, reconstruct):
    markers = made_markers(36)
    positions = np.where(np.eye(36, dtype=bool)[:, :, None], markers.positions_m, np.nan)
    path = tmp_path / "flicker.trc"
    write_trc(replace(markers, positions_m=positions), path)
    words = [path, "--unit", "mm"]
    scale([*words, "--mass", "75"], "no frame shows 6 markers", "reference36")
    reconstruct(words, "markers")


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "mm"), (MM, "m")])
def test_markers_in_the_wrong_unit(factor, unit, tmp_path, everywhere):
    markers = made_markers(20)
    path = build_c3d(tmp_path / "unit.c3d", factor * markers.positions_m, list(markers.names), unit=unit)
    everywhere(path, path, f"read in {unit}", "which no person does", "--unit")


def test_unit_given_wrongly(person, scale, reconstruct):
    scale([person.static, "--mass", "75", "--unit", "m"], "from the fitted body", "--unit")
    reconstruct([person.trial, "--unit", "m"], "fit", "--unit")
    reconstruct([person.trial, "--unit", "inch"], "unknown", "'inch'", "mm")
    reconstruct([person.trial, "--up", "w"], "unknown", "'w'", "z")


def test_plate_without_calibration(tmp_path, everywhere):
    markers = made_markers(20)
    for plate, words in (
        (Plate(4, np.ones((20, 6))), "without CAL_MATRIX"),
        (Plate(2, np.ones((20, 6)), corners=np.zeros((3, 4))), "CORNERS"),
    ):
        path = build_c3d(tmp_path / "p.c3d", MM * markers.positions_m, list(markers.names), (plate,))
        everywhere(path, path, "force plate 1", words, "calibrate it", "--forces")


def test_nan_forces(person, tmp_path, everywhere, refused, reconstruct):
    first, second = made_plates()
    broken = np.array(second.force_n)
    broken[300:310] = np.nan
    path = tmp_path / "nan.c3d"
    write_c3d(made_capture(plates=(first, replace(second, force_n=broken))), path)
    everywhere(path, path, "plate 2", "not numbers", "0.300 s", "leave the plate out")
    table = read_storage(person.forces)
    columns = np.array(table.columns)
    columns[300, 1] = np.nan
    write_storage(replace(table, columns=columns), tmp_path / "nan.mot")
    words = [person.trial_trc, "--forces", tmp_path / "nan.mot"]
    reconstruct(words, "nan.mot", "set '1'", "not numbers", "0.300 s")
    refused(["info", *words], "nan.mot", "set '1'", "not numbers")


@pytest.mark.parametrize("mass", ["0", "-70", "nan", "inf"])
def test_mass_that_cannot_be(mass, person, scale):
    scale([person.static, f"--mass={mass}"], "mass", "positive", "kg")


@pytest.mark.parametrize("mass", ["0.0", "-70.0", "nan"])
def test_subject_whose_mass_cannot_be(mass, person, tmp_path, reconstruct):
    path = tmp_path / "person.toml"
    path.write_text(person.subject.read_text().replace("mass_kg = 75.0", f"mass_kg = {mass}"))
    reconstruct([person.trial, "--subject", path], "mass must be positive", mass)


def test_mass_that_nobody_states(person, scale):
    scale([person.trial_trc], "--mass KG")


@pytest.mark.parametrize("height", ["-1", "0", "176", "nan"])
def test_height_that_cannot_be(height, person, scale):
    scale([person.static, "--mass", "75", f"--height={height}"], "height must be between 0.5 and 2.6 m", height)


@pytest.mark.parametrize(
    ("content", "fragments"),
    [
        ('name="x"\n[[marker]]\nname="RASI"\nsegment="tail"\nposition_m=[0,0,0]\n', ["'tail'", "pelvis", "RASI"]),
        ('name="x"\n[[marker]]\nname="RASI"\nlandmark="tail_tip"\n', ["'tail_tip'"]),
        ('name="x"\n[[marker]]\nname="RASI"\nsegment="pelvis"\nposition_m=[0,0]\n', ["RASI", "three"]),
        ('[[marker]]\nname="RASI"\nsegment="pelvis"\nposition_m=[0,0,0]\n', ["not a valid protocol", "name"]),
        ('name="x"\n', ["not a valid protocol", "marker"]),
        ("name=", ["not a valid protocol"]),
        (None, ["protocol.toml", "cannot be read"]),
    ],
    ids=["segment", "landmark", "position", "no name", "no markers", "no TOML", "missing"],
)
def test_broken_protocol(content, fragments, person, tmp_path, scale):
    path = tmp_path / "protocol.toml"
    if content is not None:
        path.write_text(content)
    scale([person.static, "--mass", "75", "--protocol", path], path, *fragments)


def test_unknown_protocol(person, scale):
    scale([person.static, "--mass", "75", "--protocol", "reference63"], "'reference63'", "reference36")


def test_nothing_to_scale_on(scale):
    scale(["--mass", "75"], "static trial", "--trial")


def test_output_folder_that_is_a_file(person, tmp_path, refused):
    blocked = tmp_path / "file"
    blocked.write_text("mine")
    for out in (blocked, blocked / "below"):
        words = ["reconstruct", person.trial, "--subject", person.subject, "--out", out]
        refused(words, blocked, "file", "folder", "--out")
    refused(["scale", person.static, "--mass", "75", "--out", blocked / "s.toml"], blocked, "file", "folder")


def test_output_file_that_is_a_folder(person, tmp_path, refused):
    folder = tmp_path / "folder"
    folder.mkdir()
    refused(["scale", person.static, "--mass", "75", "--out", folder], folder, "is a folder", "--out")


def test_output_in_a_missing_parent_is_made(person, tmp_path, capsys):
    subject, out = tmp_path / "a" / "b" / "s.toml", tmp_path / "c" / "d"
    assert main(["scale", str(person.static), "--out", str(subject)]) == 0
    assert main(["reconstruct", str(person.trial), "--subject", str(subject), "--out", str(out)]) == 0
    assert subject.is_file()
    assert (out / "summary.json").is_file()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "c"]


@pytest.mark.parametrize(
    ("change", "fragments"),
    [
        (None, ["no such file", "mbkf scale"]),
        (lambda text: "", ["not a subject file", "body", "mbkf scale"]),
        (lambda text: "\x00\xff", ["not a subject file", "mbkf scale"]),
        (lambda text: text[: len(text) // 2], ["not a subject file", "mbkf scale"]),
        (lambda text: text.replace("position_m = [", "position_m = [nan, "), ["not a subject file", "three"]),
        (lambda text: text.replace('segment = "pelvis"', 'segment = "tail"'), ["unknown segment 'tail'", "pelvis"]),
        (lambda text: text.replace('body = "human18"', 'body = "human19"'), ["'human19'", "human18"]),
        (lambda text: text.replace("head = ", "haed = "), ["unknown scale factor 'haed'", "head"]),
        (lambda text: text.partition("[[marker]]")[0], ["0 of the subject's markers"]),
    ],
    ids=["missing", "empty", "binary", "cut", "position", "segment", "body", "factor", "no markers"],
)
def test_broken_subject(change, fragments, person, tmp_path, reconstruct):
    path = tmp_path / "person.toml"
    if change is not None:
        path.write_text(change(person.subject.read_text()))
    reconstruct([person.trial, "--subject", path], *fragments)


def test_folder_as_subject(person, tmp_path, reconstruct):
    reconstruct([person.trial, "--subject", tmp_path], tmp_path, "folder", "mbkf scale")


@pytest.mark.parametrize("text", ["RASI", "RASI@1", "RASI@a:b", "@0:1", "RASI@:", "RASI@0:nan", "RASI@1:0"])
def test_malformed_hide(text, person, reconstruct):
    reconstruct([person.trial, "--hide", text], "--hide")


def test_unknown_hidden_marker_and_plate(person, reconstruct):
    reconstruct([person.trial, "--hide", "RASX@0:1"], "--hide", "unknown marker 'RASX'", "RASI")
    reconstruct([person.trial, "--without-plate", "7"], "--without-plate", "unknown plate '7'", "1, 2")
    reconstruct([person.trial_trc, "--without-plate", "1"], "--without-plate", "unknown plate '1'", "none")
    reconstruct([person.trial, "--filter", "magic"], "--filter", "'magic'", "kinematic")


def test_unusable_forces_file(person, tmp_path, reconstruct):
    path = tmp_path / "grf.mot"
    words = [person.trial_trc, "--forces", path]
    reconstruct(words, path, "no such file", "MOT")
    path.write_text("nothing")
    reconstruct(words, path, "not a MOT or STO file")
    times = np.arange(100) / RATE_HZ
    write_storage(Table(("Fx", "Fy"), times, np.ones((100, 2))), path)
    reconstruct(words, path, "Fx, Fy", "ground_force")
    write_storage(Table(("ground_force_vx", "ground_force_vy"), times, np.ones((100, 2))), path)
    reconstruct(words, path, "ground_force_vz", "missing")


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may read and write everything")
def test_places_without_permission(person, tmp_path, everywhere, refused):
    hidden = tmp_path / "hidden.trc"
    hidden.write_bytes(person.trial_trc.read_bytes())
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    out = closed / "out"
    refused(["reconstruct", person.trial, "--subject", person.subject, "--out", out], closed, "permission denied")
    refused(["scale", person.static, "--out", out], closed, "permission denied")


def test_legs_alone_are_followed(person, tmp_path, capsys):
    from mbkf.io.results_folder import read_reconstruction, read_summary

    legs = only(made_markers(), ("pelvis", "thigh", "shank", "foot", "toes"))
    write_c3d(made_capture(markers=legs), tmp_path / "legs.c3d")
    words = ["reconstruct", tmp_path / "legs.c3d", "--subject", person.subject, "--out", tmp_path / "out"]
    assert main([str(word) for word in words]) == 0
    found, summary = read_reconstruction(tmp_path / "out"), read_summary(tmp_path / "out")
    assert "right_upper_arm_x" in found.held_dofs
    assert any("held" in warning and "right_upper_arm_x" in warning for warning in summary["warnings"])
    held = np.isin(found.dof_names, found.held_dofs)
    assert found.sd_q[-1][held].min() > np.deg2rad(4.9)  # as far as people's postures differ
    assert summary["marker_rms_mm"] < 3.0
    assert np.isfinite(found.q[found.tracked]).all()
    assert main(["scale", str(tmp_path / "legs.c3d"), "--out", str(tmp_path / "legs.toml")]) == 0


@pytest.mark.parametrize("command", ["info", "scale", "reconstruct"])
def test_from_the_shell(command, person, tmp_path):
    """Everything a person sees, in a process of its own."""
    missing = str(tmp_path / "none.c3d")
    more = {
        "info": [],
        "scale": ["--mass", "75", "--out", str(tmp_path / "s.toml")],
        "reconstruct": ["--subject", str(person.subject), "--out", str(tmp_path / "out")],
    }[command]
    words = [sys.executable, "-m", "mbkf", command, missing, *more]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"mbkf: error: {missing}: no such file; name a C3D file\n"
    assert list(tmp_path.iterdir()) == []
