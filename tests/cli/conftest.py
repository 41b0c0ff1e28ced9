"""Fixtures of the tests that call the command line."""

import os

import pytest

from mbkf.cli.main import main
from tests.captures import Person, snapshot, write_person


@pytest.fixture(scope="session")
def person(tmp_path_factory) -> Person:
    """Captures, ground reactions and subject of one made person; nobody writes there."""
    return write_person(tmp_path_factory.mktemp("person"))


@pytest.fixture
def refused(tmp_path, capsys):
    """Checks that a call ends as bad input must, and leaves the folder as it was."""

    def check(words, *fragments):
        before = snapshot(tmp_path)
        try:
            code = main([str(word) for word in words])
        except SystemExit as end:
            code = end.code
        shown = capsys.readouterr()
        assert (code, shown.out) == (2, ""), shown.err
        assert shown.err.count("\n") == 1
        assert shown.err.startswith("mbkf")
        for fragment in fragments:
            assert str(fragment) in shown.err
        assert snapshot(tmp_path) == before

    return check


@pytest.fixture
def everywhere(person, tmp_path, refused):
    """A bad capture is refused alike by each command that reads it."""

    def check(path, *fragments):
        refused(["info", path], *fragments)
        refused(["scale", path, "--mass", "75", "--out", tmp_path / "s.toml"], *fragments)
        refused(
            ["scale", person.static, "--trial", path, "--mass", "75", "--out", tmp_path / "s.toml"],
            *fragments,
        )
        refused(["reconstruct", path, "--subject", person.subject, "--out", tmp_path / "out"], *fragments)

    return check


@pytest.fixture
def refuse_scale(tmp_path, refused):
    return lambda words, *fragments: refused(["scale", *words, "--out", tmp_path / "s.toml"], *fragments)


@pytest.fixture
def refuse_reconstruct(person, tmp_path, refused):
    """`mbkf reconstruct` of a trial, with the made person unless the words name another."""

    def check(words, *fragments):
        subject = [] if "--subject" in words else ["--subject", person.subject]
        refused(["reconstruct", *words, *subject, "--out", tmp_path / "out"], *fragments)

    return check


WINDOWS = {
    "wslpath": r"""[ "$1" = -w ] && printf '\\\\wsl.localhost\\Ubuntu%s' "$(printf %s "$2" | tr / '\\')" && exit
[ "$2" = 'C:\Users\Ána\OneDrive\Desktop' ] && echo {desktop}""",
    "powershell.exe": r"printf 'C:\\Users\\Ána\\OneDrive\\Desktop\r\n'",
    "explorer.exe": "printf '%s' \"$1\" > {opened}; exit 1",
}
"""Scripts in place of programs of WSL and Windows."""


@pytest.fixture
def wsl(tmp_path, monkeypatch):
    """A folder with fake programs of Windows at the head of PATH."""
    places = {"desktop": tmp_path / "Desktop", "opened": tmp_path / "opened"}
    for name, text in WINDOWS.items():
        program = tmp_path / "bin" / name
        program.parent.mkdir(exist_ok=True)
        program.write_text("#!/bin/sh\n" + text.format(**places) + "\n", encoding="utf-8")
        program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("WSL_DISTRO_NAME", "Ubuntu")
    return tmp_path
