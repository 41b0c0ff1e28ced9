"""Commands end as calls say: with their words, their exit code, within their time, their memory and their user."""

import os
import sys
from dataclasses import replace

import pytest

from benchmarks.misuse.calls import Call, Commands, Ending, commands


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    with commands(tmp_path_factory.mktemp("servers"), 1) as found:
        yield found


def ending(code, err=""):
    return Ending(code, "", err, 1.0, 0.0)


@pytest.mark.parametrize(
    ("end", "clean", "refused"),
    [
        (ending(0), True, False),
        (ending(2, "warning: x\nmbkf: error: a.c3d: is a folder; name a file"), True, True),
        (ending(2, ""), False, False),
        (ending(1, "mbkf: error: unexpected MemoryError"), False, False),
        (ending(2, "Traceback (most recent call last):\nmbkf: error: x"), False, False),
        (ending(-11), False, False),
        (ending(None), False, False),
    ],
)
def test_a_clean_end_is_success_or_a_sentence(end, clean, refused):
    assert (end.unclean == "") is clean
    assert end.refused is refused


def test_commands_run_in_their_folder_and_print_as_usual(run: Commands, tmp_path):
    listed = run.run(Call(["protocol", "list"], tmp_path))
    assert listed.code == 0
    assert "plug_in_gait" in listed.out
    missing = run.run(Call(["info", "missing.c3d"], tmp_path))
    assert missing.refused
    assert "missing.c3d" in missing.last_line


def test_a_command_that_waits_for_ever_is_ended(run: Commands, tmp_path):
    waits = Call(["app", str(tmp_path / "lab"), "--no-browser"], tmp_path, seconds=0.5)
    assert run.run(waits).code is None


def test_a_page_is_asked_for_its_sessions_and_ended(run: Commands, tmp_path):
    (tmp_path / "lab" / "P1").mkdir(parents=True)
    (tmp_path / "lab" / "P1" / "walk.c3d").write_bytes(b"no capture")
    end = run.run(Call(["app", str(tmp_path / "lab"), "--no-browser"], tmp_path, serves=True))
    assert (end.code, end.unclean) == (0, "")
    assert replace(end, unanswered="/session: URLError").unclean == "/session: URLError"


@pytest.mark.skipif(
    not sys.platform.startswith("linux") and os.geteuid() == 0, reason="root reads everything"
)
def test_an_unprivileged_command_may_not_read_what_modes_forbid(run: Commands, tmp_path):
    (tmp_path / "mine.trc").write_text("x")
    (tmp_path / "mine.trc").chmod(0o000)
    end = run.run(Call(["info", "mine.trc"], tmp_path, unprivileged=True))
    assert end.refused
    assert "permission" in end.last_line.lower()
