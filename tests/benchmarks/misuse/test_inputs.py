"""Strange files stand where inputs were, and a command that takes or dies of one is named."""

import stat

import pytest

from benchmarks.misuse.calls import Ending
from benchmarks.misuse.cases import CASES, Case
from benchmarks.misuse.inputs import KINDS, Strange, end_rows, strange_inputs, wrong_end

SCALE = Case("scale", "{static} --out {OUT}", "new.toml")


def ending(code, err="mbkf: error: static.c3d: is a pipe; name a file"):
    return Ending(code, "", err, 0.3, 10.0)


def test_every_input_of_every_command_is_replaced_once():
    found = list(strange_inputs(CASES))
    assert len(found) == len({(one.case.command, one.name, one.file, one.kind) for one in found})
    assert {one.case.command for one in found} >= {
        "info",
        "scale",
        "reconstruct",
        "live",
        "export",
        "imu synth",
    }


@pytest.mark.parametrize(
    ("kind", "is_kind"),
    [
        ("a folder", stat.S_ISDIR), ("a pipe", stat.S_ISFIFO), ("/dev/zero", stat.S_ISCHR), ("a socket", stat.S_ISSOCK),
        ("without end", stat.S_ISREG),
    ],
)  # fmt: skip
def test_kinds_are_what_they_are_called(tmp_path, monkeypatch, kind, is_kind):
    monkeypatch.chdir(tmp_path)  # paths of sockets must be short
    path = tmp_path / "x"
    held = KINDS[kind](path.relative_to(tmp_path))
    assert is_kind(path.stat().st_mode)
    if hasattr(held, "close"):
        held.close()


@pytest.mark.parametrize(
    ("kind", "end", "right"),
    [
        ("a pipe", ending(2), True),
        ("a pipe", ending(0), False),
        ("a folder", ending(0), True),
        ("a pipe", ending(None), False),
        ("without end", ending(1, "mbkf: error: unexpected MemoryError"), False),
    ],
)
def test_a_sentence_is_right_and_taking_a_device_is_not(kind, end, right):
    strange = Strange(SCALE, "static", "", kind)
    assert (wrong_end(strange, end) == "") is right
    assert end_rows([strange], [end])[0].passed is right
