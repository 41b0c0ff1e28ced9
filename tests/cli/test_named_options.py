"""Messages name options that exist, and those of other commands with the commands that have them."""

import ast
from pathlib import Path

import pytest

from mbkf.cli.main import build_parser, main
from mbkf.cli.named_options import OPTION, commands_of, with_commands
from mbkf.errors import InvalidInput

ROOT = Path(__file__).parents[2] / "mbkf"
BROWSER = ROOT / "viz" / "film" / "browser.py"
"""Names options of a browser."""

WINDOWS = ROOT / "cli" / "shortcut.py"
"""Names options of Windows' wsl."""

OPTIONS = dict(commands_of(build_parser()))


def texts(path: Path) -> list[str]:
    """Texts of a module that are no docstrings, with {} for what is put into them."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    pieces = {id(one) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for one in node.values}
    pieces |= {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    found = [
        "".join(one.value if isinstance(one, ast.Constant) else "{}" for one in node.values)
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr)
    ]
    return found + [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in pieces
    ]


def test_options_that_messages_name_exist():
    known = {"--version", *(option for options in OPTIONS.values() for option in options)}
    paths = sorted(set(ROOT.rglob("*.py")) - {BROWSER, WINDOWS})
    named = {option for path in paths for text in texts(path) for option in OPTION.findall(text)}
    assert len(named) > 50
    assert named - known == set()


@pytest.mark.parametrize("command", sorted(OPTIONS))
def test_a_command_names_its_own_options(command):
    path = ROOT / "cli" / f"{command.replace(' ', '_')}.py"
    wrong = [text for text in texts(path) if with_commands(text, command, OPTIONS) != text]
    assert wrong == []


def test_an_option_of_other_commands_stands_with_them():
    options = {
        "scale": frozenset({"--up", "--mass"}),
        "imu orient": frozenset({"--rate"}),
        "batch": frozenset(),
    }
    assert with_commands("give --up", "scale", options) == "give --up"
    assert with_commands("give --up", "batch", options) == "give --up; --up is an option of mbkf scale"
    assert with_commands("scale with --mass 60", "batch", options) == "scale with --mass 60"
    assert (
        with_commands("give --rate", "scale", options)
        == "give --rate; --rate is an option of mbkf imu orient"
    )
    assert with_commands("--no-such", "scale", options) == "--no-such"


def test_an_error_names_the_command_of_an_option(monkeypatch, capsys):
    def refused(args):
        raise InvalidInput("the walk is too short; change --lag")

    monkeypatch.setattr("mbkf.cli.info.run", refused)
    assert main(["info", "walk.c3d"]) == 2
    assert "; --lag is an option of mbkf reconstruct" in capsys.readouterr().err
