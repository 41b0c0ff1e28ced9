"""`mbkf export` on the command line."""

import numpy as np
import pytest

from mbkf.cli.export import add_parser
from mbkf.cli.main import OneLineParser
from mbkf.io.subject import Subject, SubjectMarker, write_subject


def command(*words):
    parser = OneLineParser(prog="mbkf")
    add_parser(parser.add_subparsers())
    return parser.parse_args(["export", *map(str, words)])


def test_a_subject_becomes_a_file(tmp_path, capsys):
    marker = SubjectMarker("C7", "torso", np.array([-0.08, 0.0, 0.3]), 0.005, 0.0)
    write_subject(Subject("human18", 70.0, {}, (marker,), "reference36"), tmp_path / "s.toml")
    args = command(tmp_path / "s.toml", "--to", "mjcf", "--out", tmp_path / "s.xml")
    assert args.run(args) == 0
    assert "<freejoint" in (tmp_path / "s.xml").read_text()
    assert capsys.readouterr().out.strip() == str(tmp_path / "s.xml")


def test_help_has_an_example_and_formats_are_checked(capsys):
    with pytest.raises(SystemExit) as end:
        command("--help")
    assert end.value.code == 0
    assert "mbkf export subject.toml --to urdf --out subject.urdf" in capsys.readouterr().out
    with pytest.raises(SystemExit) as end:
        command("s.toml", "--to", "fbx", "--out", "x")
    assert end.value.code == 2
