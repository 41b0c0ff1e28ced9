"""`mbkf info` shows what a capture holds, as tables and as JSON, and passes errors on."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.main import build_parser
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import Capture, CaptureEvent, MarkerTrajectories, PlateReadings
from mbkf.io.trc import write_trc
from tests.captures import made_capture
from tests.mot_files import write_forces_mot


@pytest.fixture
def folder(tmp_path):
    """A C3D file, and the same as TRC and MOT."""
    heights = np.linspace(0.05, 1.7, 8)
    positions = np.tile(np.column_stack([0.1 * heights, -0.2 * heights, heights]), (20, 1, 1))
    positions[5:8, 2] = np.nan
    markers = MarkerTrajectories(("HEAD", "[x]", "LASI", "RASI", "C7", "*5", "*6", "*7"), positions, 100.0)
    force = np.zeros((200, 3))
    force[:100, 2] = 650.0
    point = np.where(force[:, 2:] > 0, [0.1, 0.1, 0.0], np.nan)
    plate = PlateReadings("1", 1000.0, 0.0, np.array([0.1, 0.1, 0.0]), force, 0.0 * force, point, 20.0)
    capture = Capture(
        "", markers, (plate,), events=(CaptureEvent("Foot Strike", "Left", 0.05),), subject_mass_kg=66.0
    )
    write_c3d(capture, tmp_path / "walk.c3d")
    write_trc(markers, tmp_path / "walk.trc")
    write_forces_mot([plate], tmp_path / "walk.mot")
    return tmp_path


def run(*words) -> int:
    args = build_parser(["info"]).parse_args(["info", *(str(word) for word in words)])
    return args.run(args)


def test_tables_name_what_there_is(folder, capsys):
    assert run(folder / "walk.c3d") == 0
    shown = capsys.readouterr().out
    for text in ("walk.c3d", "20 at 100 Hz", "5 labelled, 3 unlabelled", "1.88 % of samples missing", "650 N",
                 "50 %", "[x]", "Foot Strike", "66 kg", "15.0 %", "z up, mm"):  # fmt: skip
        assert text in shown, text


def test_the_protocol_stands_in_table_and_json(tmp_path, capsys):
    whole = made_capture(5, 0.0)
    for kept, told, name in (
        (30, "knows 30 of 36 markers (83 %), 6 more inferred; joined to reference36 by", "reference36"),
        (12, "marker set inferred: 36 markers on", "inferred"),
    ):
        names = tuple(n if i < kept else f"X{i}" for i, n in enumerate(whole.markers.names))
        path = tmp_path / f"{kept}.c3d"
        write_c3d(replace(whole, markers=replace(whole.markers, names=names)), path)
        assert run(path) == 0
        assert told in " ".join(capsys.readouterr().out.split())
        assert run(path, "--json") == 0
        found = json.loads(capsys.readouterr().out)["protocol"]
        assert (found["name"], found["markers"], found["accepted"]) == (name, 36, True)
        assert found["known"] == (36 if found["told"] else kept)
        assert set(found["ignored"]) == (set() if found["told"] else set(names[kept:]))


def test_json_holds_the_same(folder, capsys):
    assert run(folder / "walk.c3d", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["frames"], found["labelled"], found["unlabelled"], found["subject_mass_kg"]) == (
        20,
        5,
        3,
        66.0,
    )
    assert found["markers"][2] == {"name": "LASI", "missing_fraction": pytest.approx(0.15), "pieces": 2}
    assert found["plates"][0]["peak_n"] == pytest.approx(650.0)
    assert found["events"] == [{"label": "Foot Strike", "context": "Left", "time_s": 0.05}]


def test_forces_of_another_file(folder, capsys):
    assert run(folder / "walk.trc", "--forces", folder / "walk.mot", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["plates"][0]["corners_m"] is None
    assert found["plates"][0]["loaded_fraction"] == 0.5
    assert run(folder / "walk.trc", "--forces", folder / "walk.mot") == 0
    assert "not in the file" in capsys.readouterr().out


def test_a_plate_is_withheld_before_the_capture_is_judged(folder, capsys):
    assert run(folder / "walk.c3d", "--without-plate", "1", "--json") == 0
    shown = json.loads(capsys.readouterr().out)
    assert (shown["plates"], shown["plates_mass"], shown["plate_contradictions"]) == ([], None, [])
    with pytest.raises(UnknownName, match="unknown plate '2'"):
        run(folder / "walk.c3d", "--without-plate", "2")


def test_plates_that_contradict_the_feet_are_reported(tmp_path, capsys):
    whole = made_capture(12)
    pulling = tuple(
        replace(plate, force_n=-plate.force_n, moment_nm=-plate.moment_nm) for plate in whole.plates
    )
    write_c3d(replace(whole, plates=pulling), tmp_path / "a.c3d")
    assert run(tmp_path / "a.c3d") == 0
    assert "pull feet down; check their sign" in capsys.readouterr().out


def test_axis_and_unit_can_be_given(folder, capsys):
    assert run(folder / "walk.trc", "--up", "z", "--unit", "cm", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["up_axis"], found["length_unit"]) == ("z", "cm")


def test_errors_are_left_to_the_caller(folder):
    with pytest.raises(FileFormatError, match="no such file"):
        run(folder / "none.c3d")
