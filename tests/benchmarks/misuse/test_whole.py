"""Torn files of each format are told from whole ones."""

import json

import pytest

from benchmarks.misuse.calls import Ending
from benchmarks.misuse.full_disk import wrong_end
from benchmarks.misuse.whole import torn, torn_files
from mbkf.io.results_folder import write_reconstruction
from tests.io.reconstructions import made_up

TEXTS = {
    "a.toml": ('a = "b"\n', 'a = "b'),
    "a.json": ('{"a": 1}\n', '{"a": '),
    "a.csv": ("a,b\n1,2\n", "a,b\n1,"),
    "a.html": ("<html></html>\n", "<html>"),
    "a.xml": ("<a><b/></a>", "<a><b/>"),
    "a.bvh": ("MOTION\nFrames: 2\nFrame Time: 0.01\n0\n0\n", "MOTION\nFrames: 2\nFrame Time: 0.01\n0\n"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_without_its_end_is_torn(tmp_path, name):
    for text, whole in zip(TEXTS[name], (True, False), strict=True):
        (tmp_path / name).write_text(text)
        assert (torn(tmp_path / name) == "") is whole


def test_files_of_a_result_are_whole_until_they_are_cut(tmp_path):
    result = made_up()
    write_reconstruction(result, {"frames": result.frames}, tmp_path)
    assert torn_files(tmp_path) == []
    for name in ("motion.h5", "angles.mot", "markers.trc"):
        content = (tmp_path / name).read_bytes()
        (tmp_path / name).write_bytes(content[: len(content) // 2])
    assert {line.partition(":")[0] for line in torn_files(tmp_path)} == {
        "motion.h5",
        "angles.mot",
        "markers.trc",
    }


@pytest.mark.parametrize(
    ("code", "err", "now", "right"),
    [
        (2, "mbkf: error: {now}/a.toml: No space left on device", "old = 1\n", True),
        (2, "mbkf: error: No space left on device", "old = 1\n", False),
        (2, "mbkf: error: {now}/.a-0123456789abcdef0123456789abcdef.toml: No space left", "old = 1\n", False),
        (2, "mbkf: error: {now}/a.toml: No space left on device", "new = 1\n", False),
        (2, "", "old = 1\n", False),
        (0, "", "new = 1\n", True),
        (0, "", "new = ", False),
        (1, "mbkf: error: unexpected OSError", "old = 1\n", False),
    ],
)
def test_a_full_disk_leaves_the_old_whole_and_is_told(tmp_path, code, err, now, right):
    for place, text in (("old", "old = 1\n"), ("now", now)):
        (tmp_path / place).mkdir()
        (tmp_path / place / "a.toml").write_text(text)
    end = Ending(code, "", err.format(now=tmp_path / "now"), 1.0, 0.0)
    assert (wrong_end(end, tmp_path / "old", tmp_path / "now") == "") is right


def test_a_file_that_tells_of_the_newest_run_may_be_another(tmp_path):
    for place in ("old", "now"):
        (tmp_path / place / "new").mkdir(parents=True)
        (tmp_path / place / "new" / "live.json").write_text(json.dumps(place))
    end = Ending(2, "", f"mbkf: error: {tmp_path / 'now'}: No space left on device", 1.0, 0.0)
    assert wrong_end(end, tmp_path / "old", tmp_path / "now") == "refused, but new/live.json is another"
    assert wrong_end(end, tmp_path / "old", tmp_path / "now", ("live.json",)) == ""


def test_a_file_that_a_killed_command_left_unfinished_is_not_torn(tmp_path):
    hexadecimal = "0f" * 16
    (tmp_path / f".summary-{hexadecimal}.parquet").write_bytes(b"")
    (tmp_path / f".result-{hexadecimal}").mkdir()
    (tmp_path / f".result-{hexadecimal}" / "motion.h5").write_bytes(b"")
    assert torn_files(tmp_path) == []
    (tmp_path / "motion.h5").write_bytes(b"")
    assert [line.partition(":")[0] for line in torn_files(tmp_path)] == ["motion.h5"]
