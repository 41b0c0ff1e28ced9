"""No text of a file steers the terminal, and none ends a command for its letters."""

import ast
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import mbkf
from mbkf.cli.tables import table
from mbkf.cli.terminal import STEERING, Guarded, console, guarded_output, show_traceback, visible

EVIL = "HEAD\x1b]0;owned\x07\x1b[2J\x9b31m\u202eabc\r\x7f\udcff"
CLI = Path(mbkf.__file__).parent / "cli"


class Screen(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


def test_letters_that_steer_are_codes_and_others_stay():
    assert visible("a\tb\n±°é…😀") == "a\tb\n±°é…😀"
    assert visible("\x1b[2J\x9b\u202e\udcff") == "\\u001b[2J\\u009b\\u202e\\udcff"
    assert STEERING.search(visible("".join(map(chr, range(0x3000))))) is None


def test_json_stays_json():
    with io.StringIO() as screen:
        Guarded(screen).write(json.dumps({"name": EVIL}, ensure_ascii=False))
        assert json.loads(screen.getvalue()) == {"name": EVIL}


def test_everything_printed_passes_the_door(monkeypatch):
    out, err = Screen(), Screen()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    with guarded_output():
        print(EVIL)
        print(EVIL, file=sys.stderr)
        sys.stderr.writelines([EVIL, EVIL])
        console().print(EVIL)
        console(stderr=True).print(EVIL, soft_wrap=True)
    assert (sys.stdout, sys.stderr) == (out, err)
    for screen, times in ((out, 2), (err, 4)):
        assert STEERING.search(screen.getvalue()) is None
        assert screen.getvalue().count("\\u001b]0;owned") == times


def test_tables_keep_the_colours_of_mbkf(monkeypatch):
    screen = Screen()
    monkeypatch.setattr(sys, "stdout", screen)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    shown = table(EVIL, "marker", "mm")
    shown.add_row(EVIL, "5")
    with guarded_output():
        console().print(shown)
    text = screen.getvalue()
    assert "\x1b[" in text
    assert "\x1b]0;" not in text and "\x1b[2J" not in text and "\x9b" not in text and "\u202e" not in text


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_letters_that_the_terminal_lacks_are_codes(encoding, monkeypatch):
    content = io.BytesIO()
    screen = io.TextIOWrapper(content, encoding=encoding, newline="\n")
    monkeypatch.setattr(sys, "stdout", screen)
    with guarded_output():
        print(json.dumps({"name": "é…😀\udcff"}, ensure_ascii=False))
    assert screen.errors == "strict"
    screen.flush()
    assert json.loads(content.getvalue().decode(encoding)) == {"name": "é…😀\udcff"}


def test_a_traceback_passes_the_door(monkeypatch):
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    try:
        raise ValueError(EVIL)
    except ValueError as error:
        show_traceback(ValueError, error, error.__traceback__)
    assert "Traceback" in screen.getvalue()
    assert STEERING.search(screen.getvalue()) is None


def test_commands_have_no_other_way_to_the_terminal():
    """Consoles are made in one place, and streams are those of ``sys``, which the door replaces.

    A text of the program itself may pass by.
    """
    for file in CLI.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if file.name != "terminal.py" and isinstance(node, ast.Call):
                own_text = isinstance(node.args[-1] if node.args else None, ast.Constant)
                assert own_text or ast.unparse(node.func) not in {"Console", "os.write", "rich.print"}, (
                    file.name
                )
            if isinstance(node, ast.Attribute):
                assert node.attr not in {"__stdout__", "__stderr__"}, file.name


@pytest.mark.parametrize("settings", [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONUTF8": "0"}])
def test_a_command_names_a_file_of_any_bytes(settings, tmp_path):
    name = os.fsencode(tmp_path) + b"/walk\xff\xe9\x1b[2J.c3d"
    call = [sys.executable, "-m", "mbkf", "info", name]
    done = subprocess.run(call, capture_output=True, env={**os.environ, **settings}, check=False)
    assert done.returncode == 2
    assert b"no such file" in done.stderr
    assert b"\x1b" not in done.stderr
