"""What the README tells people to type is what works and what continuous integration runs."""

import re
import shlex
import subprocess
from pathlib import Path

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


def test_commands_are_understood():
    """A command that is not ends this test with the parser's message."""
    parser = build_parser()
    for line in SHELL_LINES:
        if line.startswith("mbkf "):
            parser.parse_args(shlex.split(line)[1:])


def test_every_command_has_its_row():
    assert re.findall(r"^\| `mbkf (\w+)` \|", README, re.MULTILINE) == list(COMMANDS)


def test_python_compiles_and_uses_names_that_exist():
    assert PYTHON_BLOCKS
    for source in PYTHON_BLOCKS:
        compile(source, "README.md", "exec")
    names = re.findall(r"\bmbkf\.(\w+)", "\n".join(PYTHON_BLOCKS))
    assert [name for name in names if not hasattr(mbkf, name)] == []


def test_linked_files_exist():
    targets = re.findall(r"\]\(([^)#:]+)\)", re.sub(r"<!--.*?-->", "", README))
    assert [target for target in targets if not (ROOT / target).exists()] == []
