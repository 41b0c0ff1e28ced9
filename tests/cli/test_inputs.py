"""No command replaces one of its inputs, or, unasked, a file of another program; a new command is tested, too."""

from argparse import ArgumentParser, _SubParsersAction

import pytest

from mbkf.cli.inputs import OTHER_PARTS
from mbkf.cli.main import build_parser, main
from mbkf.cli.options import OUTPUTS
from mbkf.io.results_folder import LABELS_FILE, write_reconstruction
from mbkf.stream.run import report, sensor_standing
from mbkf.study.batch import inputs, person, tables
from tests.io.reconstructions import made_up

NAMES = ("walk.c3d", "person.toml", "imus.csv", "motion.h5", "labels.json", "page.html")
"""Inputs by kind, one of which each option takes; a command refuses before it reads them."""

WRITES_NOTHING = {
    "info", "replay", "observability", "app", "presets", "protocol list", "protocol check", "imu replay",
}  # fmt: skip
"""Commands that write no file that is named in their call; the page's files have tests of their own."""


def leaves(parser: ArgumentParser, name: str = "") -> dict[str, ArgumentParser]:
    groups = [one for one in parser._actions if isinstance(one, _SubParsersAction)]
    if not groups:
        return {name: parser}
    found = {}
    for word, one in groups[0].choices.items():
        found |= leaves(one, f"{name} {word}".strip())
    return found


COMMANDS = leaves(build_parser())
WRITING = {name: one for name, one in COMMANDS.items() if one.get_default(OUTPUTS)}
OF_FILES = [
    (name, one.dest)
    for name, parser in WRITING.items()
    for one in parser.get_default(OUTPUTS)
    if not one.folder
]
OF_FOLDERS = [
    (name, one.dest) for name, parser in WRITING.items() for one in parser.get_default(OUTPUTS) if one.folder
]


def words(parser: ArgumentParser, without: str, file) -> list[str]:
    """A call with the least that the parser wants, its inputs all the same file; without the option ``without``."""
    call = []
    for action in parser._actions:
        if action.dest in {without, "help"}:
            continue
        value = action.choices[0] if isinstance(action.choices, tuple | list) else str(file)
        if action.type is not None:
            value = "1"
        if not action.option_strings:
            call += [value]
        elif action.required:
            call += [f"{action.option_strings[0]}={value}"]
    return call


def option(parser: ArgumentParser, dest: str) -> str:
    return next(one.option_strings[0] for one in parser._actions if one.dest == dest)


def test_every_command_that_takes_a_file_or_folder_to_write_is_guarded():
    """An option that is called like an output passes `add_out`; a command without one is listed here by its name."""
    assert {name for name in COMMANDS if name not in WRITING} == WRITES_NOTHING
    for name, parser in WRITING.items():
        known = {one.dest for one in parser.get_default(OUTPUTS)}
        assert {
            one.dest for one in parser._actions if one.dest in {"out", "html", "curves", "figure", "record"}
        } == known, name
        assert any("--overwrite" in one.option_strings for one in parser._actions), name


@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize(("command", "dest"), OF_FILES)
@pytest.mark.parametrize("how", ["same", "link", "overwrite"])
def test_an_output_that_is_an_input_is_refused(how, command, dest, kind, tmp_path, capsys):
    parser, file = COMMANDS[command], tmp_path / kind
    file.write_bytes(b"# written by mbkf\n")
    out = file
    if how == "link":
        out = tmp_path / f"link{file.suffix}"
        out.symlink_to(file)
    call = [*command.split(), *words(parser, dest, file), f"{option(parser, dest)}={out}"]
    if how == "overwrite":
        call.append("--overwrite")
    taken = any(str(file) in word for word in call[: -1 - (how == "overwrite")])
    assert main(call) == 2
    assert file.read_bytes() == b"# written by mbkf\n"
    if taken:
        error = capsys.readouterr().err
        assert "input" in error and kind in error and error.count("\n") == 1


@pytest.mark.parametrize(("command", "dest"), OF_FILES)
def test_a_file_of_another_program_is_refused_before_the_work(command, dest, tmp_path, capsys):
    parser, out = COMMANDS[command], tmp_path / "precious.c3d"
    out.write_bytes(b"raw")
    call = [*command.split(), *words(parser, dest, tmp_path / "walk.c3d"), f"{option(parser, dest)}={out}"]
    assert main(call) == 2
    assert "not written by mbkf" in (error := capsys.readouterr().err) and "--overwrite" in error
    assert out.read_bytes() == b"raw"


@pytest.mark.parametrize(("command", "dest"), OF_FOLDERS)
def test_a_file_in_the_place_of_a_folder_stays(command, dest, tmp_path):
    parser, file = COMMANDS[command], tmp_path / "walk.c3d"
    file.write_bytes(b"raw")
    for extra in ([], ["--overwrite"]):
        call = [*command.split(), *words(parser, dest, file), f"{option(parser, dest)}={file}", *extra]
        assert main(call) == 2
        assert file.read_bytes() == b"raw"


def test_synth_leaves_the_captures_of_a_laboratory(tmp_path, capsys):
    (tmp_path / "trial.c3d").write_bytes(b"raw")
    assert main(["synth", "--seconds", "0.5", "--out", str(tmp_path)]) == 2
    assert "trial.c3d" in capsys.readouterr().err
    assert [(one.name, one.read_bytes()) for one in tmp_path.iterdir()] == [("trial.c3d", b"raw")]
    assert main(["synth", "--motion", "squat", "--seconds", "1", "--out", str(tmp_path), "--overwrite"]) == 0
    assert (tmp_path / "trial.c3d").read_bytes() != b"raw"
    assert main(["synth", "--motion", "squat", "--seconds", "1", "--out", str(tmp_path)]) == 0


def test_a_marker_set_is_edited_in_its_own_file_and_in_no_other(tmp_path):
    from argparse import Namespace

    from mbkf.cli.inputs import check_outputs, inputs_protected
    from mbkf.cli.options import Output
    from mbkf.errors import ProtectedFile

    own, other = tmp_path / "own.toml", tmp_path / "other.toml"
    for file in (own, other):
        file.write_text("name = 'mine'\n")
    outputs = (Output("out", False, "protocol", ".toml"),)
    args = Namespace(
        outputs=outputs, protocol=str(own), out=str(tmp_path / "." / "own.toml"), capture="walk.c3d"
    )
    with inputs_protected(args):
        check_outputs(args)
    args.out = str(other)
    with inputs_protected(args), pytest.raises(ProtectedFile):
        check_outputs(args)


def test_parts_of_a_folder_of_results_stay_where_a_command_makes_one_file_of_it(tmp_path, capsys):
    place = tmp_path / "results" / "P1" / "trial"
    write_reconstruction(made_up(), {"frames": 3}, place)
    part = place / "angles.mot"
    before = part.read_bytes()
    (tmp_path / "link.bvh").symlink_to(part)
    for out in (part, tmp_path / "link.bvh"):
        assert main(["export", str(place), "--to", "bvh", "--out", str(out), "--overwrite"]) == 2
        assert "input" in capsys.readouterr().err
        assert part.read_bytes() == before
    (place / "own.bvh").write_text("HIERARCHY  \t\n")  # an earlier export beside them is none
    main(["export", str(place), "--to", "bvh", "--out", str(place / "own.bvh")])
    assert "input" not in capsys.readouterr().err


def test_the_other_parts_of_results_are_named_as_their_writers_name_them():
    """The command line keeps the names itself: the modules that write these files load libraries."""
    written = {
        inputs.RECORD, person.RECORD, person.SUBJECT_FILE, LABELS_FILE, report.LIVE_FILE, sensor_standing.MOUNTS_FILE,
        *tables.TABLES,
    }  # fmt: skip
    assert written == set(OTHER_PARTS)
