"""`mbkf export` on the command line."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from mbkf.cli.main import build_parser, main
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results_folder import MOTION_FILE, write_reconstruction
from mbkf.io.subject import Subject, SubjectMarker, write_subject
from mbkf.model.body_file import load_body
from mbkf.trial.export import FORMATS, RESULT_FORMATS, export_subject
from tests.recordings import walk

FACTORS = dict.fromkeys(load_body().scale_factors, 1.0)


def command(*words):
    return build_parser(["export"]).parse_args(["export", *map(str, words)])


def test_a_subject_becomes_a_file(tmp_path, capsys):
    marker = SubjectMarker("C7", "torso", np.array([-0.08, 0.0, 0.3]), 0.005, 0.001)
    write_subject(Subject("human18", 70.0, FACTORS, (marker,), "reference36"), tmp_path / "s.toml")
    args = command(tmp_path / "s.toml", "--to", "mjcf", "--out", tmp_path / "s.xml")
    assert args.run(args) == 0
    assert "<freejoint" in (tmp_path / "s.xml").read_text()
    assert capsys.readouterr().out.strip() == str(tmp_path / "s.xml")


def test_help_has_an_example_and_formats_are_checked(capsys):
    with pytest.raises(SystemExit) as end:
        command("--help")
    assert end.value.code == 0
    told = capsys.readouterr().out
    assert "mbkf export subject.toml --to urdf --out subject.urdf" in told
    assert all(f"--to {kind}" in told for kind in (*FORMATS, *RESULT_FORMATS))
    with pytest.raises(SystemExit) as end:
        command("s.toml", "--to", "fbx", "--out", "x")
    assert end.value.code == 2


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return write_reconstruction(walk(), {}, tmp_path_factory.mktemp("result") / "walk")


@pytest.mark.parametrize(("kind", "begins"), [("c3d", b"\x02\x50"), ("bvh", b"HIERARCHY"), ("glb", b"glTF")])
def test_a_result_becomes_a_file_from_its_folder_and_from_its_motion(result, tmp_path, capsys, kind, begins):
    moved = shutil.copy(result / MOTION_FILE, tmp_path / "another name.H5")
    written = []
    for n, source in enumerate((result, result / MOTION_FILE, moved)):
        out = tmp_path / f"{n}.{kind}"
        assert main(["export", str(source), "--to", kind, "--out", str(out)]) == 0
        assert capsys.readouterr().out.strip() == str(out)
        written.append(out.read_bytes())
    assert written[0].startswith(begins) and written[0] == written[1] == written[2]


def test_a_result_becomes_a_folder_and_again(result, tmp_path, capsys):
    out = tmp_path / "for opensim"
    for _ in range(2):
        assert main(["export", str(result), "--to", "opensim", "--out", str(out)]) == 0
        assert capsys.readouterr().out.strip() == str(out)
    assert {"model.osim", "motion.mot", "setup_id.xml"} < {path.name for path in out.iterdir()}
    (tmp_path / "taken").write_text("mine")
    assert main(["export", str(result), "--to", "opensim", "--out", str(tmp_path / "taken")]) == 2
    assert (tmp_path / "taken").read_text() == "mine"


@pytest.mark.parametrize("kind", ["urdf", "osim", "c3d", "csv", "v3d", "bvh", "glb", "opensim", "bids"])
def test_formats_of_the_other_kind_are_refused_with_what_is_needed(result, tmp_path, capsys, kind):
    write_subject(Subject("human18", 70.0, FACTORS, (), "reference36"), tmp_path / "s.toml")
    of_result = kind not in FORMATS
    source = tmp_path / "s.toml" if of_result else result
    assert main(["export", str(source), "--to", kind, "--out", str(tmp_path / "x")]) == 2
    told = capsys.readouterr().err
    assert str(source) in told and f"{kind} is a format for" in told
    assert ("'mbkf reconstruct'" in told) == of_result and ("'mbkf scale'" in told) != of_result
    assert f"--to {' or '.join(FORMATS if of_result else RESULT_FORMATS)}" in told
    assert not (tmp_path / "x").exists()


def test_what_cannot_be_read_or_written_is_told(result, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    for source, kind, out, said in (
        (tmp_path / "empty", "bvh", "x.bvh", "holds no motion.h5"),
        (tmp_path / "none.h5", "bvh", "x.bvh", "none.h5"),
        (tmp_path / "none", "urdf", "x.urdf", "none"),
        (result, "c3d", "x.txt", "named .c3d"),
        (result, "glb", "empty", "is a folder"),
        (result, "bvh", "empty", "is a folder"),
    ):
        assert main(["export", str(source), "--to", kind, "--out", str(tmp_path / out)]) == 2
        assert said in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["empty"]


def test_a_trial_gives_its_plates_to_c3d_alone(result, tmp_path, capsys):
    words = ["export", str(result), "--out", str(tmp_path / "x.c3d")]
    r = walk()
    write_c3d(Capture("", MarkerTrajectories(r.marker_names, r.measured_m, r.rate_hz)), tmp_path / "t.c3d")
    assert main([*words, "--to", "c3d", "--trial", str(tmp_path / "t.c3d")]) == 0
    capsys.readouterr()
    for more, said in (
        (["--to", "csv", "--person", "07"], "of --to bids"),
        (["--to", "bvh", "--trial", "t.c3d"], "of --to c3d"),
        (["--to", "c3d", "--forces", "t.mot"], "--trial"),
    ):
        assert main([*words, *more]) == 2
        assert said in capsys.readouterr().err


def test_a_folder_of_results_becomes_one_data_set(result, tmp_path, capsys):
    words = ["--to", "bids", "--person", "07", "--out", str(tmp_path / "set")]
    assert main(["export", str(result.parent), *words]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "set")
    names = [path.name for path in (tmp_path / "set" / "sub-07" / "motion").iterdir()]
    assert "sub-07_task-walk1_tracksys-optical_motion.tsv" in names


def test_key_numbers_are_a_row_and_a_list(result, tmp_path, capsys):
    out = tmp_path / "walk.csv"
    assert main(["export", str(result), "--to", "summary", "--out", str(out)]) == 0
    assert capsys.readouterr().out.split() == [str(out), str(tmp_path / "walk_more.csv")]


def test_a_urdf_file_and_its_side_file_are_written_together_or_not_at_all(tmp_path, capsys):
    write_subject(Subject("human18", 70.0, FACTORS, (), "reference36"), tmp_path / "s.toml")
    out, side = tmp_path / "s.urdf", tmp_path / "s.urdf.toml"
    side.write_text("feet = 2", "utf-8")
    words = ["export", str(tmp_path / "s.toml"), "--to", "urdf", "--out", str(out)]
    assert main(words) == 2
    assert "s.urdf.toml" in capsys.readouterr().err
    assert not out.exists() and side.read_text("utf-8") == "feet = 2"
    assert main([*words, "--overwrite"]) == 0
    assert capsys.readouterr().out.split() == [str(out), str(side)]
    assert load_body(out).reference_mass_kg == pytest.approx(70.0)


def test_a_result_goes_onto_a_model_of_opensim(result, tmp_path, capsys):
    write_reconstruction(replace(walk(), tracked=np.arange(walk().frames) % 80 == 0), {}, tmp_path / "few")
    export_subject(walk().subject, "osim", tmp_path / "theirs.osim")
    words = ["export", str(tmp_path / "few"), "--out", str(tmp_path / "out")]
    assert main([*words, "--onto", str(tmp_path / "theirs.osim")]) == 0
    shown = capsys.readouterr().out
    assert "right_thigh" in shown and "0.0 mm from those of the reconstructed body" in shown
    assert shown.strip().endswith(str(tmp_path / "out"))
    assert (tmp_path / "out" / "setup_static_optimization.xml").is_file()
    for more in ([], ["--to", "bvh", "--onto", str(tmp_path / "theirs.osim")]):
        assert main([*words, *more]) == 2
        assert "--to" in capsys.readouterr().err
    write_subject(walk().subject, tmp_path / "s.toml")
    onto = ["--onto", str(tmp_path / "theirs.osim"), "--out", str(tmp_path / "other")]
    assert main(["export", str(tmp_path / "s.toml"), *onto]) == 2
    assert "is no result" in capsys.readouterr().err
