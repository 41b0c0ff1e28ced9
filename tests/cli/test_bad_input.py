"""Bad input gets one line that says what, where and what to do, exit code 2, and nothing half-written."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import MarkerTrajectories
from mbkf.io.storage import read_storage, write_storage
from mbkf.io.trc import write_trc
from tests.captures import made_capture, made_markers, made_plates, only
from tests.io.c3d_builder import Plate, build_c3d

MM = 1000.0


@pytest.mark.parametrize("suffix", ["c3d", "trc"])
def test_missing_file(suffix, tmp_path, everywhere):
    path = tmp_path / f"none.{suffix}"
    everywhere(path, path, "no such file", f"name a {suffix.upper()} file")


@pytest.mark.parametrize("suffix", ["c3d", "trc"])
def test_folder_instead_of_a_file(suffix, tmp_path, everywhere):
    path = tmp_path / f"folder.{suffix}"
    path.mkdir()
    everywhere(path, path, f"name a {suffix.upper()} file")


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04" * 400], ids=["empty", "text", "zip"])
def test_not_a_c3d(content, tmp_path, everywhere):
    path = tmp_path / "a.c3d"
    path.write_bytes(content)
    everywhere(path, path, "export it")


def test_not_a_trc(tmp_path, everywhere):
    path = tmp_path / "a.trc"
    path.write_text("a,b\n1,2\n")
    everywhere(path, path, "line 1", "not a TRC file", "PathFileType")


def test_other_kinds_of_file(tmp_path, everywhere):
    path = tmp_path / "a.xlsx"
    path.write_text("a,b\n1,2\n")
    everywhere(path, path, "'.xlsx' files cannot be read", ".c3d, .trc, .csv or .tsv")


@pytest.mark.parametrize(("suffix", "kind"), [("csv", "export of Motive"), ("tsv", "TSV file of Qualisys")])
def test_tables_that_are_no_captures(suffix, kind, tmp_path, everywhere):
    path = tmp_path / f"a.{suffix}"
    path.write_text("a,b\n1,2\n")
    everywhere(path, path, "line 1", f"not a{'n' if suffix == 'csv' else ''} {kind}")


@pytest.mark.parametrize("suffix", ["forces", "tsv", "csv", "txt"])
def test_tables_that_are_no_forces(suffix, person, tmp_path, refused, refuse_reconstruct):
    path = tmp_path / f"a.{suffix}"
    for content in ("", "a,b\n1,2\n"):
        path.write_text(content)
        refuse_reconstruct([person.trial_trc, "--forces", path], f"a.{suffix}")
    refused(["info", person.trial_trc, "--forces", path], f"a.{suffix}")
    refused(["info", person.trial_trc, "--forces", tmp_path / f"none.{suffix}"], "no such file")


@pytest.mark.parametrize("share", [0.001, 0.1, 0.5, 0.99])
def test_truncated_c3d(share, person, tmp_path, everywhere):
    content = person.trial.read_bytes()
    path = tmp_path / "cut.c3d"
    path.write_bytes(content[: int(share * len(content))])
    everywhere(path, path, "export it")


def test_truncated_trc(person, tmp_path, everywhere):
    lines = person.trial_trc.read_text().splitlines(keepends=True)
    path = tmp_path / "cut.trc"
    path.write_text("".join(lines[:40]).rstrip()[:-30])
    everywhere(path, path, "cut short", "copy or export it again")


def test_no_markers_of_the_protocol(person, tmp_path, refuse_scale, refuse_reconstruct):
    markers = made_markers(20)
    path = tmp_path / "strange.c3d"
    write_c3d(made_capture(20, markers=replace(markers, names=tuple(f"P{i}" for i in range(36)))), path)
    refuse_scale(
        [path, "--mass", "75", "--protocol", "reference36"],
        "0 markers",
        "reference36",
        "P0, P1",
        "--protocol",
    )
    refuse_reconstruct([path], "0 of the subject's markers", "reference36", "P0, P1")


def test_points_that_are_no_person(tmp_path, refuse_scale):
    scattered = np.random.default_rng(5).uniform([-0.4, -0.4, 0.0], [0.4, 0.4, 1.7], (36, 3))
    path = tmp_path / "scattered.trc"
    names = tuple(f"P{i}" for i in range(36))
    write_trc(MarkerTrajectories(names, np.repeat(scattered[None], 5, axis=0), 100.0), path)
    refuse_scale([path, "--up", "y", "--mass", "75"], "no upright body is found", "--protocol")


def test_too_few_markers_to_follow_any_body(tmp_path, refuse_scale, refuse_reconstruct):
    markers = made_markers(20)
    path = tmp_path / "few.c3d"
    write_c3d(made_capture(20, markers=markers.select(markers.names[:5])), path)
    refuse_scale([path, "--mass", "75"], "markers", "--protocol")
    refuse_scale([path, "--mass", "75", "--protocol", "reference36"], "5 markers", "--protocol")
    refuse_reconstruct([path], "5 of the subject's markers", "at least 6")


def test_markers_that_are_never_seen_together(tmp_path, refuse_scale, refuse_reconstruct):
    markers = made_markers(36)
    positions = np.where(np.eye(36, dtype=bool)[:, :, None], markers.positions_m, np.nan)
    path = tmp_path / "flicker.trc"
    write_trc(replace(markers, positions_m=positions), path)
    words = [path, "--unit", "mm"]
    refuse_scale([*words, "--mass", "75"], "no frame shows 6 markers", "reference36")
    refuse_reconstruct(words, "markers")


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "mm"), (MM, "m")])
def test_markers_in_the_wrong_unit(factor, unit, tmp_path, everywhere):
    markers = made_markers(20)
    path = build_c3d(tmp_path / "unit.c3d", factor * markers.positions_m, list(markers.names), unit=unit)
    everywhere(path, path, f"read in {unit}", "unlike any person", "--unit")


@pytest.mark.slow
def test_unit_given_wrongly(person, refuse_scale, refuse_reconstruct):
    refuse_scale([person.static, "--mass", "75", "--unit", "m"], "outside 0.65 to 2.6 m", "--unit mm")
    refuse_reconstruct([person.trial, "--unit", "m"], "outside 0.65 to 2.6 m", "--unit mm")
    refuse_reconstruct([person.trial, "--unit", "furlong"], "unknown", "'furlong'", "mm")
    refuse_reconstruct([person.trial, "--up", "w"], "unknown", "'w'", "z")


def told(capsys, *words):
    """Output of a call that succeeds, in one line."""
    assert main([str(word) for word in words]) == 0
    return " ".join(capsys.readouterr().out.split())


def test_a_plate_that_cannot_be_read_is_left_out_and_named(tmp_path, capsys):
    markers = made_markers(20)
    for plate, words in (
        (Plate(4, np.ones((20, 6))), "without CAL_MATRIX"),
        (Plate(2, np.ones((20, 6)), corners=np.zeros((3, 4))), "no usable CORNERS"),
    ):
        path = build_c3d(tmp_path / "p.c3d", MM * markers.positions_m, list(markers.names), (plate,))
        shown = told(capsys, "info", path)
        assert "force plate 1 is left out" in shown and words in shown and "--forces" in shown


def test_nan_forces(person, tmp_path, capsys, refused, refuse_reconstruct):
    first, second = made_plates()
    broken = np.array(second.force_n)
    broken[300:310] = np.nan
    path = tmp_path / "nan.c3d"
    write_c3d(made_capture(plates=(first, replace(second, force_n=broken))), path)
    assert "force plate 2 is left out: 10 of" in told(capsys, "info", path)
    table = read_storage(person.forces)
    columns = np.array(table.columns)
    columns[300, 1] = np.nan
    write_storage(replace(table, columns=columns), tmp_path / "nan.mot")
    words = [person.trial_trc, "--forces", tmp_path / "nan.mot"]
    shown = told(capsys, "info", *words)
    assert "force plate 1 is left out: 1 of" in shown and "0.300 s" in shown
    columns[300, :] = np.nan
    write_storage(replace(table, columns=columns), tmp_path / "nan.mot")
    refuse_reconstruct(words, "nan.mot", "set '1'", "not numbers", "0.300 s")
    refused(["info", *words], "nan.mot", "set '1'", "not numbers")


@pytest.mark.slow
def test_legs_alone_are_followed(person, tmp_path, capsys):
    from mbkf.io.results_folder import read_reconstruction, read_summary

    legs = only(made_markers(), ("pelvis", "thigh", "shank", "foot", "toes"))
    write_c3d(made_capture(markers=legs), tmp_path / "legs.c3d")
    words = ["reconstruct", tmp_path / "legs.c3d", "--subject", person.subject, "--out", tmp_path / "out"]
    assert main([str(word) for word in words]) == 0
    found, summary = read_reconstruction(tmp_path / "out"), read_summary(tmp_path / "out")
    assert "right_upper_arm_x" in found.unobserved_dofs
    assert any(
        "neutral posture" in warning and "right_upper_arm_x" in warning for warning in summary["warnings"]
    )
    unobserved = np.isin(found.dof_names, found.unobserved_dofs)
    assert found.sd_q[-1][unobserved].min() > np.deg2rad(4.9)  # as far as people's postures differ
    assert summary["marker_rms_mm"] < 3.0
    assert np.isfinite(found.q[found.tracked]).all()
    assert main(["scale", str(tmp_path / "legs.c3d"), "--out", str(tmp_path / "legs.toml")]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("command", ["scale", "reconstruct"])
def test_from_the_shell(command, person, tmp_path):
    """Everything a person sees, in a process of its own."""
    missing = str(tmp_path / "none.c3d")
    more = {
        "scale": ["--mass", "75", "--out", str(tmp_path / "s.toml")],
        "reconstruct": ["--subject", str(person.subject), "--out", str(tmp_path / "out")],
    }[command]
    words = [sys.executable, "-m", "mbkf", command, missing, *more]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"mbkf: error: {missing}: no such file; name a C3D file\n"
    assert list(tmp_path.iterdir()) == []
