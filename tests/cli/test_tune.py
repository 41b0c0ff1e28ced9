"""`mbkf tune` writes a preset that `mbkf reconstruct --preset` uses; bad usage ends in one line."""

import json

import pytest

from mbkf.cli.main import main
from mbkf.cli.tune import positions
from mbkf.errors import UnknownName
from mbkf.io.c3d_write import write_c3d
from mbkf.io.preset import read_preset
from mbkf.io.trc import write_trc
from tests.captures import made_capture
from tests.mot_files import write_forces_mot

pytestmark = pytest.mark.slow

FRAMES = 152


@pytest.fixture(autouse=True)
def presets(monkeypatch, tmp_path):
    """The user's presets, none at first."""
    folder = tmp_path / "presets"
    monkeypatch.setenv("MBKF_PRESETS", str(folder))
    return folder


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    """A trial long enough to be halved, as C3D, and as TRC with MOT."""
    folder = tmp_path_factory.mktemp("tune")
    capture = made_capture(FRAMES)
    write_c3d(capture, folder / "long.c3d")
    write_trc(capture.markers, folder / "long.trc")
    write_forces_mot(capture.plates, folder / "grf.mot")
    return folder / "long.c3d"


@pytest.fixture
def tune(person):
    def call(*words):
        return main(["tune", *(str(word) for word in words), "--subject", str(person.subject)])

    return call


@pytest.fixture
def refuse_tune(person, refused):
    def check(words, *fragments):
        refused(["tune", *words, "--subject", person.subject], *fragments)

    return check


def test_a_preset_is_saved_and_used(trial, person, tune, presets, tmp_path, capsys):
    assert tune(trial, "--name", "lab", "--runs", "2", "--parameters", "motion") == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    assert "acceleration scale" in shown.out
    assert "held out: long, second half" in shown.out
    saved = read_preset(presets / "lab.toml")
    assert saved.filter == "dynamic"
    assert set(saved.values) == {"acceleration_scale"}
    assert set(saved.likelihood) == {"tuned_before", "tuned_after", "held_out_before", "held_out_after"}
    out = tmp_path / "out"
    words = ["reconstruct", str(person.trial), "--subject", str(person.subject), "--out", str(out)]
    assert main([*words, "--preset", "lab", "--causal"]) == 0
    settings = json.loads((out / "summary.json").read_text())["settings"]
    assert settings["dynamic"]["acceleration_scale"] == saved.values["acceleration_scale"]


def test_several_trials_of_the_kinematic_filter(trial, tune, presets, tmp_path):
    out = tmp_path / "new" / "k.toml"
    trc = trial.with_suffix(".trc")
    words = ["--forces", trial.with_name("grf.mot"), "--name", "k", "--filter", "kinematic", "--out", out]
    assert tune(trial, trc, *words, "--runs", "1", "--hold-out", trial, "--keep-markers") == 0
    saved = read_preset(out)
    assert (saved.tuned_on, saved.held_out) == (("long",), ("long",))
    assert not presets.exists()


def test_presets_of_the_torque_filter(person, tmp_path):
    out = tmp_path / "out"
    words = ["reconstruct", str(person.trial), "--subject", str(person.subject), "--out", str(out)]
    assert main([*words, "--preset", "FDMC", "--causal"]) == 0
    summary = json.loads((out / "summary.json").read_text())
    assert summary["filter"] == "torque"
    assert summary["settings"]["torque"]["scheme"]["integrator"] == "FE"


def test_bad_usage(trial, person, tmp_path, refuse_tune, refuse_reconstruct):
    name = ["--name", "x"]
    refuse_tune([trial], "--name")
    refuse_tune([*name], "TRIAL")
    refuse_tune([trial, "--name", "a/b"], "--name 'a/b'")
    refuse_tune([trial, "--name", "FD"], "another name")
    refuse_tune([trial, *name, "--filter", "torque"], "'torque'")
    refuse_tune([trial, *name, "--runs", "0"], "--runs")
    refuse_tune([trial, *name, "--hold-out", "run"], "--hold-out", "'run'", "long.c3d")
    refuse_tune([trial, *name, "--hold-out", "long"], "held out")
    refuse_tune([trial, *name, "--parameters", "motoin"], "--parameters", "did you mean motion")
    refuse_tune([trial, *name, "--forces", trial.with_name("grf.mot")], "--forces", "0 of the trials")
    refuse_tune([person.trial, *name], "too short")
    refuse_tune([trial, *name, "--out", tmp_path], tmp_path, "is a folder", "--out")
    refuse_tune([trial.with_name("none.c3d"), *name], "none.c3d")
    refuse_reconstruct([person.trial, "--preset", "none"], "--preset", "unknown preset 'none'", "FDMC")
    refuse_reconstruct([person.trial, "--preset", "FD", "--filter", "dynamic"], "torque filter", "--filter")
    refuse_reconstruct([person.trial, "--preset", trial], "long.c3d")
    refuse_reconstruct([person.trial, "--preset", "FD", "--set", "integrater=HE"], "did you mean integrator")
    refuse_tune([trial, *name, "--set", "gat=3"], "did you mean gate")
    refuse_tune([trial, *name, "--preset", "FD"], "'torque'")


def test_held_out_trials_are_found_by_any_of_their_names():
    trials = ["a/walk1.c3d", "b/walk1.c3d", "b/run.trc"]
    assert positions(trials, []) is None
    assert positions(trials, ["b/walk1.c3d"]) == (1,)
    assert positions(trials, ["walk1", "run.trc"]) == (0, 1, 2)
    with pytest.raises(UnknownName, match="'walk'"):
        positions(trials, ["walk"])
