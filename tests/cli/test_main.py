"""Wrong usage and bad input end in one line and exit code 2; help gives examples and is quick."""

import os
import re
import subprocess
import sys
from argparse import ArgumentParser, Namespace, _SubParsersAction

import pytest

from mbkf.cli import imu, norms, protocol
from mbkf.cli import main as cli
from mbkf.cli.main import COMMANDS, build_parser, main
from mbkf.errors import FileFormatError
from mbkf.kernel.loading import kernel_name
from mbkf.version import __version__


def usage(words: list[str], capsys) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a call that argparse ends."""
    with pytest.raises(SystemExit) as end:
        main(words)
    shown = capsys.readouterr()
    return end.value.code, shown.out, shown.err


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ([], "COMMAND"),
        (["reconstrcut"], "reconstrcut"),
        (["--nonsense"], "COMMAND"),
        (["scale"], "--out"),
        (["info"], "FILE"),
        (["demo", "--nonsense"], "--nonsense"),
        (["demo", "--seconds", "many"], "many"),
    ],
)
def test_wrong_usage_exits_with_2_and_one_line(words, named, capsys):
    code, out, err = usage(words, capsys)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert named in err
    assert "--help" in err


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_each_command_gives_an_example(command, capsys):
    code, out, _ = usage([command, "--help"], capsys)
    assert code == 0
    assert re.search(rf"^example[s]?:?\n\s+mbkf {command}", out, re.MULTILINE | re.IGNORECASE)


def test_help_lists_every_command_with_what_it_does(capsys):
    code, out, _ = usage(["--help"], capsys)
    assert code == 0
    for command in COMMANDS:
        assert re.search(rf"^    {command}\s+\S+ \S+", out, re.MULTILINE), command


def test_version(capsys):
    assert usage(["--version"], capsys) == (0, f"mbkf {__version__}, {kernel_name()}\n", "")


def parsers(parser: ArgumentParser) -> list[ArgumentParser]:
    """A parser and those of its commands."""
    nested = [action for action in parser._actions if isinstance(action, _SubParsersAction)]
    return [parser, *(one for action in nested for sub in action.choices.values() for one in parsers(sub))]


def test_each_command_of_a_group_has_its_help_its_example_and_its_work():
    ends = [parser for parser in parsers(build_parser()) if "run" in parser._defaults]
    assert len(ends) == len(COMMANDS) - 3 + len(imu.SUBCOMMANDS + norms.SUBCOMMANDS + protocol.SUBCOMMANDS)
    for parser in ends:
        assert callable(parser.get_default("run"))
        assert re.match(rf"Examples?:\n  {parser.prog}", parser.epilog), parser.prog


def test_paragraphs_of_the_help_are_filled_and_examples_kept(monkeypatch, capsys):
    for columns in ("60", "140"):
        monkeypatch.setenv("COLUMNS", columns)
        _, out, _ = usage(["batch", "--help"], capsys)
        lines = out.splitlines()
        assert "  mbkf batch trials.csv --out results --workers 8" in lines
        (first,) = (line for line in lines if line.startswith("A folder with captures"))
        assert 0.8 * int(columns) < len(first) <= int(columns)


def test_help_loads_no_slow_library():
    code = (
        "import sys; from mbkf.cli.main import build_parser; build_parser(); "
        "print(*sorted({'pinocchio', 'casadi', 'scipy', 'matplotlib', 'meshcat', 'pyarrow'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


@pytest.fixture
def outcome(monkeypatch):
    """Replace the work of every command by raising what the test asks for."""

    def end_with(error: BaseException) -> int:
        def run(_args):
            raise error

        parser = build_parser(["demo"])
        monkeypatch.setattr(parser, "parse_args", lambda _words: Namespace(run=run))
        monkeypatch.setattr(cli, "build_parser", lambda _commands: parser)
        return main(["demo"])

    return end_with


@pytest.mark.parametrize(
    ("error", "code", "text"),
    [
        (FileFormatError("a.c3d", "not a C3D file"), 2, "a.c3d: not a C3D file"),
        (PermissionError(13, "Permission denied", "out"), 2, "out: permission denied"),
        (FileExistsError(17, "File exists", "out"), 2, "out: a file has the name of the folder to write"),
        (NotADirectoryError(20, "Not a directory", "out/x"), 2, "out/x: a file has the name"),
        (IsADirectoryError(21, "Is a directory", "out"), 2, "out: is a folder"),
        (FileNotFoundError(2, "No such file or directory", "a.c3d"), 2, "a.c3d: No such file"),
        (OSError("no room\nleft"), 2, "no room left"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (ValueError("odd"), 1, "unexpected ValueError: odd. This is a bug in mbkf"),
    ],
)
def test_failures_are_one_line(outcome, monkeypatch, capsys, error, code, text):
    monkeypatch.delenv(cli.TRACEBACK_VARIABLE, raising=False)
    assert outcome(error) == code
    err = capsys.readouterr().err
    assert err.startswith(f"mbkf: error: {text}")
    assert err.count("\n") == 1


def test_a_bug_can_be_traced(outcome, monkeypatch):
    monkeypatch.setenv(cli.TRACEBACK_VARIABLE, "1")
    with pytest.raises(ValueError, match="odd"):
        outcome(ValueError("odd"))


@pytest.mark.slow
def test_missing_file_and_unusable_folder_end_in_one_line(tmp_path):
    """The real command line, with everything it prints on stderr."""
    blocked = tmp_path / "file"
    blocked.write_text("")
    for words in (["info", str(tmp_path / "none.c3d")], ["synth", "--motion", "walk", "--out", str(blocked)]):
        done = subprocess.run(
            [sys.executable, "-m", "mbkf", *words], capture_output=True, text=True, check=False, timeout=300
        )
        assert (done.returncode, done.stdout) == (2, ""), done.stderr
        assert done.stderr.startswith("mbkf: error: ")
        assert done.stderr.count("\n") == 1


def test_reader_that_leaves_is_no_error():
    """`mbkf … | head -0`: the pipe is closed before anything is written."""
    code = (
        "import sys; from argparse import Namespace; from mbkf.cli import main as cli\n"
        "class Parser:\n"
        "    def parse_args(self, words): return Namespace(run=lambda args: print('x'))\n"
        "cli.build_parser = lambda names: Parser()\n"
        "sys.exit(cli.main(['demo']))"
    )
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-c", code], stdout=write, stderr=subprocess.PIPE, check=False)
    os.close(write)
    assert (done.returncode, done.stderr) == (cli.EXIT_PIPE_CLOSED, b"")
