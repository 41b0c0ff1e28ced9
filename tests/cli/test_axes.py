"""Captures in wrong axes on the command line: put right with one line about it, kept by --axes, or refused."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.records import AxesSource
from mbkf.io.results_folder import read_summary
from mbkf.io.subject import read_subject
from mbkf.io.trc import write_trc
from mbkf.io.turning import turned
from tests.captures import MASS_KG, made_capture
from tests.mot_files import write_forces_mot

pytestmark = pytest.mark.slow

MIRROR = np.diag([1.0, -1.0, 1.0])
Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""What a TRC file with z up looks like to a reader that takes y as up."""

HEAD_DOWN = np.diag([1.0, -1.0, -1.0])


def bare(capture):
    """Without the plates' corners, which no MOT file holds."""
    return replace(capture, plates=tuple(replace(plate, corners_m=None) for plate in capture.plates))


@pytest.fixture(scope="module")
def misread(tmp_path_factory):
    """Static and trial with ground reactions, once mirrored, once with z up, as TRC and MOT files."""
    folder = tmp_path_factory.mktemp("axes")
    static, trial = bare(made_capture(30, 0.0)), bare(made_capture())
    for name, turn in (("right", np.eye(3)), ("mirrored", MIRROR), ("z_up", Z_UP), ("head_down", HEAD_DOWN)):
        write_trc(turned(static, turn, AxesSource.BODY).markers, folder / f"static_{name}.trc")
        there = turned(trial, turn, AxesSource.BODY)
        write_trc(there.markers, folder / f"{name}.trc")
        write_forces_mot(there.plates, folder / f"{name}.mot")
    return folder


def run(*words) -> int:
    return main([str(word) for word in words])


def followed(folder, name, out):
    """Exit codes of scaling and reconstruction of one way of storing the captures, written below a folder."""
    words = ["--forces", folder / f"{name}.mot", "--subject", out / "subject.toml"]
    words += ["--filter", "kinematic", "--causal", "--out", out / "result"]
    return (
        run("scale", folder / f"static_{name}.trc", "--mass", MASS_KG, "--out", out / "subject.toml"),
        run("reconstruct", folder / f"{name}.trc", *words),
    )


@pytest.fixture(scope="module")
def right(misread, tmp_path_factory):
    """The summary of the capture in its true axes."""
    out = tmp_path_factory.mktemp("right")
    assert followed(misread, "right", out) == (0, 0)
    return read_summary(out / "result")


@pytest.mark.parametrize(
    ("name", "told", "axes"),
    [
        ("mirrored", "markers mirrored: z flipped", {"up": "y", "forward": "x", "mirrored": True}),
        ("z_up", "axes put right: x,y,z", {"up": "z", "forward": "x", "mirrored": False}),
    ],
)
def test_misread_captures_give_the_right_persons_numbers(misread, right, tmp_path, capsys, name, told, axes):
    capsys.readouterr()
    assert followed(misread, name, tmp_path) == (0, 0)
    assert told in capsys.readouterr().out
    found = read_summary(tmp_path / "result")
    assert found["axes"] == {**axes, "source": "body"}
    assert sum("--axes=x,-z,y keeps them" in one for one in found["warnings"]) == 1
    assert right["axes"]["source"] == "default"
    assert not any("keeps them" in one for one in right["warnings"])
    for key in ("marker_rms_mm", "residual_force_rms_n", "residual_moment_rms_nm"):
        assert found[key] == pytest.approx(right[key], rel=1e-3, abs=1e-3), key
    for joint, peak in right["torque_peak_nm_per_kg"].items():
        assert found["torque_peak_nm_per_kg"][joint] == pytest.approx(peak, rel=1e-3, abs=1e-4), joint


def test_info_tells_what_it_found(misread, capsys):
    assert run("info", misread / "mirrored.trc", "--json") == 0
    axes = json.loads(capsys.readouterr().out)["axes"]
    assert (axes["read"], axes["verdict"], axes["used"]) == ("x,-z,y", "put right", "x,z,y")
    assert run("info", misread / "mirrored.trc") == 0
    assert "right markers lay left" in " ".join(capsys.readouterr().out.split())
    assert run("info", misread / "mirrored.trc", "--axes", "x,z,y") == 0
    assert "given" in capsys.readouterr().out


def test_given_axes_say_the_same(misread, tmp_path):
    found = [tmp_path / "body.toml", tmp_path / "given.toml"]
    static = misread / "static_mirrored.trc"
    assert run("scale", static, "--mass", MASS_KG, "--out", found[0]) == 0
    assert run("scale", static, "--mass", MASS_KG, "--axes", "x,z,y", "--out", found[1]) == 0
    by_body, given = (read_subject(path) for path in found)
    assert by_body.scale_factors == given.scale_factors
    assert ("axes" in by_body.report, "axes" in given.report) == (True, False)


def test_contradictions_are_refused_in_one_line(misread, person, tmp_path, refused):
    trial = [misread / "head_down.trc", "--forces", misread / "right.mot", "--subject", person.subject]
    refused(["reconstruct", *trial, "--out", tmp_path / "out"], "head_down.trc", "plates push", "--axes")
    refused(["info", misread / "right.trc", "--axes", "x,y"], "forward, left and up")
    refused(["info", misread / "right.trc", "--axes", "x,-z,y", "--up", "z"], "give one")


def test_points_without_names_follow_the_static_trial(misread, tmp_path):
    """A mirrored laboratory: the static trial tells, the unlabelled points of the trial cannot."""
    raw = tmp_path / "raw.trc"
    named = read_capture(misread / "mirrored.trc", axes="x,-z,y").markers
    write_trc(replace(named, names=tuple(f"*{i}" for i in range(len(named.names)))), raw)
    static = misread / "static_mirrored.trc"
    out = tmp_path / "named.trc"
    assert run("label", raw, "--static", static, "--mass", MASS_KG, "--out", out) == 0
    labelled, right = read_capture(out).markers, read_capture(misread / "right.trc").markers
    for name in labelled.names:
        np.testing.assert_allclose(
            labelled.select((name,)).positions_m, right.select((name,)).positions_m, atol=1e-5, err_msg=name
        )


def test_a_mirrored_c3d_with_plates_is_put_right(person, tmp_path):
    """Points and corners mirrored along the floor, channels as the plates read: as if plates faced downwards."""
    there = turned(made_capture(), MIRROR, AxesSource.BODY)
    write_c3d(there, tmp_path / "mirrored.c3d")
    words = ["--subject", person.subject, "--filter", "kinematic", "--causal", "--out"]
    assert run("reconstruct", tmp_path / "mirrored.c3d", *words, tmp_path / "mirrored") == 0
    assert run("reconstruct", person.trial, *words, tmp_path / "right") == 0
    mirrored, right = (read_summary(tmp_path / name) for name in ("mirrored", "right"))
    assert mirrored["axes"]["mirrored"]
    assert mirrored["axes"]["source"] == "body"
    for key in ("marker_rms_mm", "residual_force_rms_n", "residual_moment_rms_nm", "valid_frames"):
        assert mirrored[key] == pytest.approx(right[key], rel=1e-3, abs=1e-3), key
