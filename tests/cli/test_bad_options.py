"""Masses, protocols, subjects, options and outputs that cannot be: one line, code 2, nothing half-written."""

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.storage import Table, write_storage
from tests.captures import RATE_HZ


@pytest.mark.parametrize("mass", ["0", "-70", "nan", "inf"])
def test_mass_that_cannot_be(mass, person, refuse_scale):
    refuse_scale([person.static, f"--mass={mass}"], "mass", "positive", "kg")


@pytest.mark.parametrize("mass", ["0.0", "-70.0", "nan"])
def test_subject_whose_mass_cannot_be(mass, person, tmp_path, refuse_reconstruct):
    path = tmp_path / "person.toml"
    path.write_text(person.subject.read_text().replace("mass_kg = 75.0", f"mass_kg = {mass}"))
    refuse_reconstruct([person.trial, "--subject", path], "mass_kg must be a number between", "kg", mass)


def test_mass_that_nobody_states(person, refuse_scale):
    refuse_scale([person.trial_trc], "--mass KG")


@pytest.mark.parametrize("command", [["synth", "--motion", "squat"], ["demo"], ["report", "result"]])
@pytest.mark.parametrize("out", ["", " "])
def test_an_output_without_a_name_is_not_the_folder_one_is_in(command, out, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*command, "--out", out]) == 2
    assert "--out is empty" in capsys.readouterr().err and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("lag", ["-5", "nan", "inf"])
def test_lag_that_cannot_be(lag, person, refuse_reconstruct):
    refuse_reconstruct([person.trial, f"--lag={lag}"], "--lag", "zero or more")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--causal", "--lag", "60"], "argument --lag: not allowed with argument --causal"),
        (["--smooth", "--lag", "60"], "argument --lag: not allowed with argument --smooth"),
        (["--causal", "--smooth"], "argument --smooth: not allowed with argument --causal"),
    ],
)
def test_which_later_frames_count_is_said_once(person, refuse_reconstruct, words, told):
    refuse_reconstruct([person.trial, *words], told)


@pytest.mark.parametrize("height", ["-1", "0", "176", "nan"])
def test_height_that_cannot_be(height, person, refuse_scale):
    refuse_scale(
        [person.static, "--mass", "75", f"--height={height}"], "height must be between 0.5 and 2.6 m", height
    )


@pytest.mark.parametrize(
    ("content", "fragments"),
    [
        (
            'name="x"\n[[marker]]\nname="RASI"\nsegment="tail"\nposition_m=[0,0,0]\n',
            ["'tail'", "pelvis", "RASI"],
        ),
        ('name="x"\n[[marker]]\nname="RASI"\nlandmark="tail_tip"\n', ["'tail_tip'"]),
        ('name="x"\n[[marker]]\nname="RASI"\nsegment="pelvis"\nposition_m=[0,0]\n', ["RASI", "three"]),
        ('[[marker]]\nname="RASI"\nsegment="pelvis"\nposition_m=[0,0,0]\n', ["not a valid protocol", "name"]),
        ('name="x"\n', ["not a valid protocol", "marker"]),
        ("name=", ["not a valid protocol"]),
        (None, ["protocol.toml", "cannot be read"]),
    ],
    ids=["segment", "landmark", "position", "no name", "no markers", "no TOML", "missing"],
)
def test_broken_protocol(content, fragments, person, tmp_path, refuse_scale):
    path = tmp_path / "protocol.toml"
    if content is not None:
        path.write_text(content)
    refuse_scale([person.static, "--mass", "75", "--protocol", path], path, *fragments)


def test_unknown_protocol(person, refuse_scale):
    refuse_scale([person.static, "--mass", "75", "--protocol", "reference63"], "'reference63'", "reference36")


def test_nothing_to_scale_on(refuse_scale):
    refuse_scale(["--mass", "75"], "static trial", "--trial")


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


@pytest.mark.slow
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
        (lambda text: "", ["scale_factors is missing"]),
        (lambda text: "\x00\xff", ["line 1: not a subject file"]),
        (lambda text: text[: text.index("position_m = [") + 20], ["not a subject file", "Unclosed array"]),
        (
            lambda text: text.replace("position_m = [", "position_m = [nan, "),
            ["line", "position_m must be 3 numbers"],
        ),
        (
            lambda text: text.replace('segment = "pelvis"', 'segment = "tail"'),
            ["unknown segment 'tail'", "pelvis"],
        ),
        (lambda text: text.replace('body = "human18"', 'body = "human19"'), ["'human19'", "human18"]),
        (lambda text: text.replace("head = ", "haed = "), ["scale_factors", "head is missing"]),
        (lambda text: text.partition("[[marker]]")[0], ["0 of the subject's markers"]),
    ],
    ids=["missing", "empty", "binary", "cut", "position", "segment", "body", "factor", "no markers"],
)
def test_broken_subject(change, fragments, person, tmp_path, refuse_reconstruct):
    path = tmp_path / "person.toml"
    if change is not None:
        path.write_text(change(person.subject.read_text()))
    refuse_reconstruct([person.trial, "--subject", path], *fragments)


def test_folder_as_subject(person, tmp_path, refuse_reconstruct):
    refuse_reconstruct([person.trial, "--subject", tmp_path], tmp_path, "folder", "mbkf scale")


@pytest.mark.parametrize("text", ["RASI", "RASI@1", "RASI@a:b", "@0:1", "RASI@:", "RASI@0:nan", "RASI@1:0"])
def test_malformed_hide(text, person, refuse_reconstruct):
    refuse_reconstruct([person.trial, "--hide", text], "--hide")


def test_unknown_hidden_marker_and_plate(person, refuse_reconstruct):
    refuse_reconstruct([person.trial, "--hide", "RASX@0:1"], "--hide", "unknown marker 'RASX'", "RASI")
    refuse_reconstruct([person.trial, "--without-plate", "7"], "--without-plate", "unknown plate '7'", "1, 2")
    refuse_reconstruct(
        [person.trial_trc, "--without-plate", "1"], "--without-plate", "unknown plate '1'", "none"
    )
    refuse_reconstruct([person.trial, "--filter", "magic"], "--filter", "'magic'", "kinematic")


def test_scaling_withholds_plates(person, refuse_scale):
    words = [person.static, "--trial", person.trial, "--mass", "auto", "--without-plate"]
    refuse_scale([*words, "7"], "--without-plate", "unknown plate '7'", "1, 2")
    refuse_scale([*words, "1", "--without-plate", "2"], "no capture has plates")


def test_unusable_forces_file(person, tmp_path, refuse_reconstruct):
    path = tmp_path / "grf.mot"
    words = [person.trial_trc, "--forces", path]
    refuse_reconstruct(words, path, "no such file", "MOT")
    path.write_text("nothing")
    refuse_reconstruct(words, path, "not a MOT or STO file")
    path.unlink()
    times = np.arange(100) / RATE_HZ
    write_storage(Table(("Fx", "Fy"), times, np.ones((100, 2))), path)
    refuse_reconstruct(words, path, "Fx, Fy", "ground_force")
    write_storage(Table(("ground_force_vx", "ground_force_vy"), times, np.ones((100, 2))), path)
    refuse_reconstruct(words, path, "ground_force_vz", "missing")


def test_places_without_permission(person, tmp_path, refused, monkeypatch):
    """As the operating system would answer; root, who may write everywhere, could not test it otherwise."""
    monkeypatch.setattr("mbkf.io.atomic.os.access", lambda place, mode: False)
    out = tmp_path / "out"
    words = ["reconstruct", person.trial, "--subject", person.subject, "--out", out]
    refused(words, tmp_path, "permission denied", "name a place")
    refused(["scale", person.static, "--out", out / "s.toml"], tmp_path, "permission denied", "name a place")
