"""`mbkf demo` prints the errors against the truth and writes its folder."""

from pathlib import Path

import pytest

from mbkf.cli.demo import run
from mbkf.cli.main import build_parser, main

pytestmark = pytest.mark.slow


def test_demo_prints_errors_and_writes_the_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A second of squat through the whole chain."""
    words = ["demo", "--motion", "squat", "--seconds", "1", "--seed", "1", "--out", str(tmp_path / "demo")]
    args = build_parser(["demo"]).parse_args(words)
    assert run(args) == 0
    printed = capsys.readouterr().out
    assert "Against the known truth" in printed
    assert "knee_angle_r" in printed
    assert (tmp_path / "demo" / "result" / "summary.json").is_file()
    assert "known truth" in (tmp_path / "demo" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("words", [["--seed", "-1"], ["--motion", "dance"], ["--seconds", "-3"]])
def test_wrong_options_are_one_line(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 2 and nothing written."""
    try:
        code = main(["demo", *words, "--out", str(tmp_path / "demo")])
    except SystemExit as left:
        code = left.code
    assert code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / "demo").exists()


def test_an_unknown_motion_is_refused(refused, tmp_path):
    refused(["demo", "--motion", "swim", "--out", tmp_path / "x"], "unknown motion 'swim'", "squat")
