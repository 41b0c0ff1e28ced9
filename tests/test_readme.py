"""What the README tells people to type is what works and what continuous integration runs."""

import re
import shlex
import subprocess
from pathlib import Path

import pytest

import mbkf
from mbkf.cli.main import COMMANDS, build_parser

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
SHELL_LINES = [line for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]
PYTHON_BLOCKS = [text for kind, text in BLOCKS if kind == "python"]


def marked(name: str) -> str:
    """The single line of the block that follows a marker."""
    (text,) = re.findall(rf"<!-- {name} -->\n```sh\n(.*?)```", README, re.DOTALL)
    (line,) = text.splitlines()
    return line


def test_continuous_integration_runs_the_test_command_of_the_readme():
    script = ROOT / ".ci" / "run"
    shown = subprocess.run([script, "--show"], capture_output=True, text=True, check=True).stdout
    assert shown == marked("test-command") + "\n"
    assert "pytest" in shown
    assert "pytest" not in script.read_text(encoding="utf-8")


def test_demo_command_makes_its_own_environment():
    assert marked("demo-command").startswith("python3 -m venv ")
    assert marked("demo-command").endswith("mbkf demo")


@pytest.mark.parametrize("line", [line for line in SHELL_LINES if line.startswith("mbkf ")])
def test_commands_are_understood(line):
    build_parser().parse_args(shlex.split(line)[1:])


def test_every_command_has_its_row():
    assert re.findall(r"^\| `mbkf (\w+)` \|", README, re.MULTILINE) == list(COMMANDS)


def test_there_is_a_python_example():
    assert PYTHON_BLOCKS


@pytest.mark.parametrize("source", PYTHON_BLOCKS)
def test_python_compiles_and_uses_names_that_exist(source):
    compile(source, "README.md", "exec")
    for name in re.findall(r"\bmbkf\.(\w+)", source):
        assert hasattr(mbkf, name), name


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)#:]+)\)", re.sub(r"<!--.*?-->", "", README)))
def test_linked_files_exist(target):
    assert (ROOT / target).exists()
