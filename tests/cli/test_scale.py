"""`mbkf scale` finds the body and the mass of a made person and writes one readable subject file."""

from argparse import ArgumentTypeError
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from mbkf.cli.main import main
from mbkf.cli.scale import AUTO, _print_inertia, mass_option
from mbkf.io.c3d_write import write_c3d
from mbkf.io.subject import read_subject
from mbkf.model.protocol import load_protocol
from tests.bending import squat, standing, walk
from tests.captures import MASS_KG, made_capture, snapshot

pytestmark = pytest.mark.slow


def scale(*words) -> int:
    return main(["scale", *(str(word) for word in words)])


@pytest.fixture
def reference():
    return {m.name: m for m in load_protocol("reference36").markers}


@pytest.mark.parametrize("source", ["static", "trial", "both"])
def test_the_made_body_is_found(source, person, reference, tmp_path, capsys):
    words = {"static": [person.static], "trial": ["--trial", person.trial],
             "both": [person.static, "--trial", person.trial]}[source]  # fmt: skip
    assert scale(*words, "--mass", "71.5", "--out", tmp_path / "s.toml") == 0
    subject = read_subject(tmp_path / "s.toml")
    assert (subject.protocol, subject.body, subject.mass_kg) == ("reference36", "human18", 71.5)
    assert list(subject.scale_factors.values()) == pytest.approx([1.0] * 18, abs=0.05)
    assert {m.name for m in subject.markers} == set(reference)
    moved = [np.linalg.norm(m.position_m - reference[m.name].position_m) for m in subject.markers]
    assert max(moved) < 0.03
    shown = capsys.readouterr().out
    assert "Scale factors" in shown
    assert "right thigh" in shown
    assert shown.splitlines()[-1].startswith(f"{tmp_path / 's.toml'}: protocol reference36")


def test_mass_comes_from_the_capture_where_it_is_stated(person, tmp_path):
    assert scale(person.static, "--out", tmp_path / "s.toml") == 0
    assert read_subject(tmp_path / "s.toml").mass_kg == MASS_KG


def test_report_is_kept_with_the_subject(person, tmp_path, capsys):
    """Inertia, where it is asked for and no plate shows it, is the table's and says so."""
    assert scale(person.static, "--out", tmp_path / "s.toml", "--height", "1.75", "--inertia") == 0
    assert "inertia by the table: no trial shows the inertia of segments" in capsys.readouterr().out
    subject = read_subject(tmp_path / "s.toml")
    assert subject.height_m == 1.75
    assert subject.report["converged"]
    assert subject.report["marker_rms_mm"] < 2.0
    factor = subject.report["factors"]["right_thigh"]
    assert factor["standard_error"] > 0.0
    assert not factor["at_bound"]
    assert set(subject.report["markers"]["RASI"]) >= {"rms_mm", "max_mm", "moved_mm", "kind"}


def test_a_second_run_replaces_the_file_and_leaves_nothing_else(person, tmp_path):
    path = tmp_path / "s.toml"
    path.write_text("# A scaled subject, written by mbkf. Lengths in m, mass in kg\nbody = 'x'\n")
    assert scale(person.static, "--out", path) == 0
    first = path.read_bytes()
    assert scale(person.static, "--out", path) == 0
    assert snapshot(tmp_path) == {"s.toml": first}


def test_trc_and_c3d_give_the_same_subject(person, tmp_path):
    for name, trial in (("c3d", person.trial), ("trc", person.trial_trc)):
        assert scale("--trial", trial, "--mass", "75", "--out", tmp_path / name) == 0
    a, b = (read_subject(tmp_path / name) for name in ("c3d", "trc"))
    assert list(a.scale_factors.values()) == pytest.approx(list(b.scale_factors.values()), abs=1e-4)


def test_joined_and_ignored_markers_are_shown_and_few_known_ones_inferred(tmp_path, capsys):
    whole = made_capture(30, 0.0, plates=())
    for kept, file in ((34, "most.c3d"), (12, "few.c3d")):
        names = tuple(n if i < kept else f"X{i}" for i, n in enumerate(whole.markers.names))
        write_c3d(replace(whole, markers=replace(whole.markers, names=names)), tmp_path / file)
    out = tmp_path / "s.toml"
    assert scale(tmp_path / "most.c3d", "--out", out) == 0
    shown = capsys.readouterr()
    assert "reference36 knows 34 of 36 markers (94 %), 2 more inferred; 0 ignored" in shown.out
    assert "note: joined to reference36 by inference: X34 (right" in shown.out
    assert "the segment of marker X34 is uncertain: right" in shown.err
    out.unlink()
    assert scale(tmp_path / "most.c3d", "--protocol", "reference36", "--out", out) == 0
    shown = capsys.readouterr()
    assert "reference36 knows 34 of 36 markers (94 %); 2 ignored: X34, X35" in shown.out
    assert "warning" not in shown.err
    out.unlink()
    assert scale(tmp_path / "few.c3d", "--out", out) == 0
    assert "note: marker set inferred: 36 markers on" in capsys.readouterr().out
    assert scale(tmp_path / "few.c3d", "--protocol", "reference36", "--out", out) == 0
    assert "warning: protocol reference36 knows 12 of 36" in capsys.readouterr().err


def renamed(path, *names):
    """The made standing trial with each marker under the next one's name, as a file."""
    whole = made_capture(30, 0.0, plates=())
    columns = [whole.markers.names.index(name) for name in names]
    positions = whole.markers.positions_m.copy()
    positions[:, columns] = whole.markers.positions_m[:, np.roll(columns, 1)]
    write_c3d(replace(whole, markers=replace(whole.markers, positions_m=positions)), path)
    return path


def test_a_doubtful_body_is_told_first_and_kept_and_an_impossible_one_leaves_no_file(tmp_path, capsys):
    out = tmp_path / "s.toml"
    doubtful = renamed(tmp_path / "doubtful.c3d", "RKNE", "RANK")
    assert scale(doubtful, "--protocol", "reference36", "--keep-names", "--out", out) == 0
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith("warning: this body may not be the person's: proportions are unusual")
    assert read_subject(out).report["doubts"] == [
        told[0].removeprefix("warning: this body may not be the person's: ")
    ]
    out.unlink()
    around = ("RKNE", "RANK", "LELB", "C7", "RHEE", "LKNE", "LANK", "RELB")
    impossible = renamed(tmp_path / "impossible.c3d", *around)
    assert scale(impossible, "--protocol", "reference36", "--keep-names", "--out", out) == 2
    assert "proportions that people do not have" in capsys.readouterr().err
    assert not out.exists()


def test_exchanged_names_of_a_static_are_put_right_and_told_with_the_way_to_keep_them(tmp_path, capsys):
    wrong, out = renamed(tmp_path / "wrong.c3d", "RKNE", "RANK"), tmp_path / "s.toml"
    assert scale(wrong, "--protocol", "reference36", "--out", out) == 0
    told = capsys.readouterr().err
    assert "the static trial exchanges the names of RKNE and RANK" in told and "--keep-names" in told
    assert read_subject(out).report["static_names_exchanged"] == [["RKNE", "RANK"]]


def test_the_mass_is_a_number_or_what_plates_tell(person, tmp_path, capsys):
    assert (mass_option("71.5"), mass_option(AUTO)) == (71.5, "auto")
    with pytest.raises(ArgumentTypeError, match="heavy"):
        mass_option("heavy")
    assert scale("--trial", person.trial_trc, "--mass", "auto", "--out", tmp_path / "s.toml") == 2
    assert "the plates do not give the body mass (no capture has plates)" in capsys.readouterr().err
    assert not (tmp_path / "s.toml").exists()
    words = ["--trial", person.trial_trc, "--mass", "auto", "--out", tmp_path / "s.toml"]
    assert scale(*words, "--forces", person.forces) == 0
    assert "by the plates of" in capsys.readouterr().out
    assert read_subject(tmp_path / "s.toml").mass_kg == pytest.approx(MASS_KG, rel=0.03)


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """A session of standing, a squat, a walk of another person and a capture that is left out, with its mass."""
    folder = tmp_path_factory.mktemp("P1")
    for name, capture in (
        ("static", standing()),
        ("squat", squat()),
        ("walk", walk(factor=1.1)),
        ("bad", walk()),
    ):
        write_c3d(capture, folder / f"{name}.c3d")
    (folder / "session.toml").write_text("mass_kg = 66.0\n[trial.bad]\nexcluded = 'stumbled'\n")
    return folder


def test_a_sessions_folder_takes_the_trials_that_help(session, tmp_path, capsys):
    assert scale(session, "--out", tmp_path / "s.toml") == 0
    subject, shown = read_subject(tmp_path / "s.toml"), capsys.readouterr().out
    assert [one["trial"] for one in subject.report["scaled_from"]] == ["static", "squat"]
    assert list(subject.report["not_scaled_from"]) == ["walk"] and subject.mass_kg == 66.0
    assert "scaled from squat (deep flexion: hips bend to 10" in shown and "stumbled" not in shown
    assert "not scaled from walk: distances between markers" in shown and "hip centres" not in shown


def test_standing_alone_states_the_use_of_a_deep_squat(session, tmp_path, capsys):
    for words in ([session, "--static-only", "--mass", "70"], [session / "static.c3d", "--mass", "70"]):
        assert scale(*words, "--out", tmp_path / "s.toml") == 0
        assert "note: hip centres are uncertain by " in capsys.readouterr().out
        assert read_subject(tmp_path / "s.toml").report["frames"] == 30


def test_trials_that_are_named_win(session, tmp_path, capsys):
    assert scale(session, "--trial", session / "bad.c3d", "--out", tmp_path / "s.toml") == 0
    subject = read_subject(tmp_path / "s.toml")
    assert subject.report["frames"] == 60 and subject.mass_kg == 66.0
    assert "hip centres" not in capsys.readouterr().out


def test_a_folder_of_sessions_names_them(session, tmp_path, capsys):
    assert scale(session.parent, "--out", tmp_path / "s.toml") == 2
    assert f"no captures lie in this folder; its sessions are {session.name}" in capsys.readouterr().err


def test_segments_are_told_with_their_standard_deviations(capsys):
    own = {
        "mass_percent": 7.6,
        "mass_percent_sd": 2.1,
        "centre_shift_mm": [3.0, -4.0, 5.0],
        "centre_shift_sd_mm": [1.0, 2.0, 3.0],
    }
    _print_inertia(Console(width=100), {"segments": {"right_thigh": own}, "told": "as told"})
    shown = capsys.readouterr().out
    assert "right thigh" in shown
    assert "+8 ± 2" in shown
    assert "-4 ± 2" in shown
    assert shown.splitlines()[-1] == "as told"
