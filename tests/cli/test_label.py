"""`mbkf label` writes the named capture and its summary, and refuses bad input in one line."""

import json

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.capture import read_capture
from mbkf.io.subject import read_subject
from mbkf.trial.label import label
from mbkf.trial.scale import scale

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A synthetic capture as `mbkf synth` writes it."""
    out = tmp_path_factory.mktemp("walk")
    assert main(["synth", "--motion", "walk", "--seconds", "1", "--out", str(out)]) == 0
    return out


def test_label_writes_capture_and_summary(folder, tmp_path, capsys):
    out = tmp_path / "named.c3d"
    words = ["label", folder / "raw.c3d", "--subject", folder / "subject.toml", "--out", out]
    assert main([str(word) for word in [*words, "--truth", folder / "trial.c3d"]]) == 0
    shown = capsys.readouterr()
    assert "ghost points dropped" in shown.out
    assert "correct" in shown.out
    summary = json.loads(out.with_suffix(".json").read_text())
    assert summary["correct_fraction"] >= 0.99
    assert summary["wrong_fraction"] <= 0.001
    assert summary["missed_fraction"] <= 0.01
    assert {"assigned_fraction", "ghosts_dropped", "swaps_repaired", "first_labelled_frame"} <= set(summary)
    truth, named = read_capture(folder / "trial.c3d"), read_capture(out)
    assert set(named.markers.names) <= set(truth.markers.names)
    assert named.markers.frames == truth.markers.frames


def test_without_truth_nothing_is_compared(folder, tmp_path):
    out = tmp_path / "named.trc"
    words = ["label", folder / "raw.c3d", "--subject", folder / "subject.toml", "--out", out]
    assert main([str(word) for word in words]) == 0
    assert "correct_fraction" not in json.loads(out.with_suffix(".json").read_text())
    truth, named = read_capture(folder / "trial.c3d").markers, read_capture(out).markers
    order = [truth.names.index(name) for name in named.names]
    off_m = np.linalg.norm(named.positions_m - truth.positions_m[:, order], axis=2)
    assert named.frames == truth.frames and (off_m[np.isfinite(off_m)] < 1e-3).mean() >= 0.99


def test_bad_input_is_refused(folder, tmp_path, refused):
    raw, subject = folder / "raw.c3d", folder / "subject.toml"
    refused(["label", raw, "--subject", subject, "--out", tmp_path / "x.csv"], "--out", ".c3d or .trc")
    refused(["label", raw, "--subject", subject, "--out", raw], "inputs are never replaced")
    refused(["label", tmp_path / "no.c3d", "--subject", subject, "--out", tmp_path / "x.c3d"], "no.c3d")
    refused(["label", raw, "--subject", tmp_path / "no.toml", "--out", tmp_path / "x.c3d"], "mbkf scale")
    refused(["label", raw, "--subject", subject], "--out")


def by_standing_trial(folder):
    """Labels and person of a search without either, which costs a quarter of a minute, from the standing trial."""

    def found(raw, protocol, *, mass_kg, height_m, progress):
        assert (protocol, mass_kg, height_m) == ("reference36", 75.0, 1.8)
        subject = scale(read_capture(folder / "static.c3d"), mass_kg=mass_kg)
        return label(raw, subject, progress=progress), subject

    return found


@pytest.mark.parametrize(
    "who", [["--static", "static.c3d"], ["--protocol", "reference36", "--height", "1.8"]]
)
def test_a_person_scaled_on_the_way_is_written(folder, tmp_path, capsys, monkeypatch, who):
    monkeypatch.setattr("mbkf.trial.label_unscaled.label_unscaled", by_standing_trial(folder))
    out = tmp_path / "named.c3d"
    who = [folder / word if word.endswith(".c3d") else word for word in who]
    words = ["label", folder / "raw.c3d", *who, "--mass", "75", "--truth", folder / "trial.c3d", "--out", out]
    assert main([str(word) for word in words]) == 0
    shown = capsys.readouterr()
    assert str(tmp_path / "named.toml") in shown.out
    subject = read_subject(tmp_path / "named.toml")
    assert subject.mass_kg == 75.0
    assert {marker.name for marker in subject.markers} >= set(read_capture(out).markers.names)
    summary = json.loads(out.with_suffix(".json").read_text())
    assert summary["correct_fraction"] >= 0.9
    doubtful = summary["doubts"]["labels"]
    assert ("warning" in shown.err) >= bool(doubtful)


def test_it_must_be_known_who_wears_the_markers(folder, tmp_path, refused):
    raw, out = folder / "raw.c3d", tmp_path / "named.c3d"
    refused(["label", raw, "--truth", raw, "--out", out], "--truth", "--protocol")
    both = ["--subject", folder / "subject.toml", "--protocol", "reference36"]
    refused(["label", raw, *both, "--out", out], "--protocol", "--subject")
    refused(["label", raw, "--protocol", "reference36", "--mass", "-3", "--out", out], "--mass", "positive")
    refused(["label", raw, "--protocol", "nosuch", "--mass", "75", "--out", out], "nosuch")
