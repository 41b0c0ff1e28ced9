"""Every command has a case, and a new command, option or format without one is noticed."""

import argparse

from benchmarks.misuse.cases import CASES, Case, uncovered


def test_every_command_option_and_format_has_a_case():
    assert uncovered() == []


def test_a_new_command_and_a_new_option_are_noticed():
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers()
    known = commands.add_parser("known")
    known.add_argument("--given", metavar="FILE")
    known.add_argument("--forgotten", metavar="FILE")
    known.add_argument("--rate", metavar="HZ")
    commands.add_parser("new")
    assert uncovered((Case("known", "--given {trial}"),), parser) == ["known --forgotten", "new"]


def test_a_format_without_a_case_is_noticed():
    assert "export --to c3d" in uncovered(tuple(case for case in CASES if "--to c3d" not in case.words))


def test_a_case_names_its_inputs_and_its_kind():
    case = Case("scale", "{static} --body {body} --out {OUT}", "new.toml")
    assert case.inputs == ("static", "body")
    assert case.kind == "file"
    assert case.call({"static": "here.c3d"}, "there.toml", "--overwrite") == [
        "scale", "here.c3d", "--body", "body.toml", "--out", "there.toml", "--overwrite",
    ]  # fmt: skip
    assert Case("batch", "{study} --out {OUT}", "new").kind == "folder"
    assert Case("info", "{trial}").kind == ""
