"""`mbkf batch` tells what failed, and by its exit code whether anything did."""

import json

import pyarrow as pa
import pytest

from mbkf.cli.batch import DOUBTS, REASONS, _print, shard_of
from mbkf.cli.main import main
from mbkf.errors import InvalidInput
from mbkf.io.verdict import Reason, Verdict
from tests.studies import ThisProcess, study

pytestmark = pytest.mark.slow


def run(*words) -> int:
    return main(["batch", *(str(word) for word in words)])


def test_a_study_is_done_and_failures_are_told(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("mbkf.study.batch.run.LocalWorkers", ThisProcess)
    source, out = study(tmp_path / "study"), tmp_path / "out"
    words = (source, "--out", out, "--workers", "1", "--filter", "kinematic", "--causal", "--spreads", "none")
    words = (*words, "--static-only")
    assert run(*words) == 0
    assert json.loads((out / "P1" / "subject.json").read_text())["settings"]["static_only"] is True
    assert capsys.readouterr().out.splitlines()[-1] == f"{out}: 1 trials done, 0 unchanged, 0 failed"
    assert (out / "P1" / "walk1" / "summary.json").is_file() and (out / "summary.csv").is_file()
    (source / "P1" / "bad.c3d").write_bytes(b"nothing")
    assert run(*words) == 1
    shown = capsys.readouterr()
    assert shown.out.splitlines()[-1] == f"{out}: 0 trials done, 1 unchanged, 1 failed"
    assert shown.err.startswith("failed: P1/bad: ")


def test_nothing_to_do_is_bad_input(tmp_path, capsys):
    assert run(tmp_path, "--out", tmp_path / "out") == 2
    assert "no trial was found" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["3", "a/b", "3/", "/16", "-1/3", "3/16/2", "1.5/2", "²/3"])
def test_a_shard_is_two_numbers(text):
    with pytest.raises(InvalidInput, match="--shard"):
        shard_of(text)


def test_a_shard_is_read():
    assert shard_of("3/16") == (3, 16) and shard_of(None) is None


def test_the_last_lines_name_the_trials_that_may_not_be_used_and_count_the_words(capsys):
    turned = Verdict.of([Reason("left_leg", "do not use", "knee 57° beyond", "turned over", "check names")])
    reasons = [json.dumps(one.as_table()["reasons"]) for one in (Verdict(), turned)]
    columns = {
        "folder": ["P1/a", "P1/b", "P1/c"], "status": ["done", "unchanged", "failed"], "reason": ["", "", "no file"],
        REASONS: [*reasons, None],
    }  # fmt: skip
    failed, words = _print(pa.table(columns), "out")
    assert (failed, words["use"], words["do not use"]) == (1, 1, 1)
    shown = capsys.readouterr()
    assert shown.out.splitlines() == [
        f"P1/b: {turned.line}",
        "may they be used? 1 use, 0 look, 1 do not use",
        "out: 1 trials done, 1 unchanged, 1 failed",
    ]
    assert shown.err == "failed: P1/c: no file\n"


def test_the_last_lines_name_each_person_whose_body_is_doubtful_once(capsys):
    columns = {
        "subject": ["P1", "P1", "P2"], "session": ["", "", "am"], "folder": ["P1/a", "P1/b", "P2/am/c"],
        "status": ["done"] * 3, "reason": [""] * 3,
        DOUBTS: ["long legs", "long legs; b: markers put on anew", ""],
    }  # fmt: skip
    _print(pa.table(columns), "out")
    assert capsys.readouterr().out.splitlines()[:-1] == ["person P1: long legs; b: markers put on anew"]
