"""`mbkf synth` writes five files that the other commands read, and refuses nonsense in one line."""

import pytest

from mbkf.cli.main import main
from mbkf.io.c3d import read_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.subject import read_subject
from mbkf.io.truth import read_truth
from mbkf.trial.synth import FILES


@pytest.mark.slow
def test_writes_a_folder(tmp_path, capsys):
    out = tmp_path / "made" / "squat"
    assert (
        main(
            [
                "synth",
                "--motion",
                "squat",
                "--seconds",
                "1.5",
                "--seed",
                "4",
                "--ghosts",
                "1",
                "--rate",
                "60",
                "--out",
                str(out),
            ]
        )
        == 0
    )
    assert sorted(path.name for path in out.iterdir()) == sorted(FILES)
    assert "squat" in capsys.readouterr().out
    truth, trial = read_truth(out / "truth.h5"), read_c3d(out / "trial.c3d", CaptureOptions())
    subject = read_subject(out / "subject.toml")
    assert trial.markers.rate_hz == 60.0
    assert trial.markers.frames == len(truth.times_s) == 91
    assert trial.markers.names == tuple(marker.name for marker in subject.markers) == truth.marker_names
    assert len(read_c3d(out / "raw.c3d", CaptureOptions()).markers.names) == len(trial.markers.names) + 1
    assert read_c3d(out / "static.c3d", CaptureOptions()).markers.present.all()


def test_help_has_an_example(capsys):
    with pytest.raises(SystemExit) as end:
        main(["synth", "--help"])
    assert end.value.code == 0
    assert "mbkf synth --motion walk" in capsys.readouterr().out


def test_out_that_is_a_file_is_refused(tmp_path, refused):
    (tmp_path / "file").write_text("x")
    refused(["synth", "--motion", "squat", "--out", tmp_path / "file"], "name another folder")


@pytest.mark.parametrize(
    "words",
    [
        ["--motion", "dance"],
        ["--seconds", "0"],
        ["--seconds", "nan"],
        ["--rate", "0"],
        ["--seed", "-1"],
        ["--occlusion", "2"],
        ["--markers-mm", "-1"],
        ["--ghosts", "-1"],
    ],
)
def test_nonsense_is_refused(words, tmp_path, refused):
    refused(["synth", *words, "--out", tmp_path / "out"])
