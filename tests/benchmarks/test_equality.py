import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from benchmarks.equality.__main__ import _chosen, main
from benchmarks.equality.captures import CAPTURES, LEFT_OUT
from benchmarks.equality.compare import BOUND, difference, numbers_in_folder, verdict
from benchmarks.equality.comparison import Beyond, Row, compared_folders, nudged, with_rounding
from benchmarks.equality.runs import Outcome, Tree
from mbkf.errors import InvalidInput

ANGLES = np.array([[0.5, -2.0], [np.nan, 1.0]])


def written(folder: Path, factor: float = 1.0, **changes: object) -> Outcome:
    """A result folder whose angles are multiplied."""
    folder.mkdir()
    with h5py.File(folder / "motion.h5", "w") as file:
        file["angles"] = ANGLES * factor
        file["dof_names"] = ["knee", "hip"]
        file["step_seconds"] = np.random.default_rng().random(3)
    summary = {"marker_rms_mm": 5.0, "by_name": {"KNE": 1.0}, "realtime_factor": factor, "truth": None}
    (folder / "summary.json").write_text(json.dumps(summary | changes), encoding="utf-8")
    return Outcome(0, "", folder)


def test_a_difference_is_a_share_of_the_largest_value():
    changed = ANGLES.copy()
    changed[0, 0] += 1e-3
    assert difference(ANGLES, ANGLES.copy()) == (0.0, "")
    assert difference(ANGLES, changed)[0] == pytest.approx(1e-3 / 2.0)
    assert difference(np.array([True, False]), np.array([True, True]))[0] == 1.0


@pytest.mark.parametrize(
    "changed",
    [
        np.nan_to_num(ANGLES),
        np.where(ANGLES == 1.0, np.nan, ANGLES),
        np.where(ANGLES == 1.0, np.inf, ANGLES),
        ANGLES[:1],
        np.array([["a", "b"], ["c", "d"]]),
    ],
)
def test_other_gaps_shapes_or_kinds_are_infinitely_far_apart(changed):
    value, why = difference(ANGLES, changed)
    assert value == np.inf
    assert why


def test_zeros_that_are_zeros_no_more_are_infinitely_far_apart():
    assert difference(np.zeros(3), np.full(3, 1e-15))[0] == np.inf
    assert difference(np.zeros(3), np.zeros(3))[0] == 0.0


def test_the_worst_array_is_named_and_additions_are_allowed():
    old = {"a": np.ones(2), "b": np.ones(2)}
    found = verdict(old, {"a": np.ones(2), "b": np.array([1.0, 1.1]), "c": np.ones(2)})
    assert (found.worst, found.arrays, found.equal) == ("b", 2, False)
    assert found.value == pytest.approx(0.1)
    assert verdict(old, {"a": np.ones(2)}).worst == "b (missing)"
    assert not verdict({}, {}).equal


def test_folders_are_equal_but_for_times(tmp_path):
    found = compared_folders(written(tmp_path / "old"), written(tmp_path / "new", realtime_factor=7.0))
    assert found.value == 0.0
    assert found.equal
    assert found.arrays == 5


def test_a_perturbed_folder_fails(tmp_path):
    old, new = written(tmp_path / "old"), written(tmp_path / "new", 1.0 + 2.0 * BOUND)
    found = compared_folders(old, new)
    assert not found.equal
    assert found.worst == "motion.h5: angles"
    assert compared_folders(old, written(tmp_path / "near", 1.0 + 0.5 * BOUND)).equal
    changed = written(tmp_path / "other", by_name={"KNE": 1.1})
    assert compared_folders(old, changed).worst == "summary.json: by_name.KNE"
    assert "NaN" in compared_folders(old, written(tmp_path / "known", truth=1.0)).worst


def test_a_renamed_array_is_found_under_its_new_name(tmp_path):
    old, new = written(tmp_path / "old"), written(tmp_path / "new")
    with h5py.File(new.folder / "motion.h5", "a") as file:
        file.move("angles", "joint_angles")
    assert compared_folders(old, new).worst == "motion.h5: angles (missing)"
    assert compared_folders(old, new, {"angles": "joint_angles"}).equal


def test_refusing_alike_is_equal_and_refusing_alone_is_not(tmp_path):
    refused = Outcome(2, "mbkf: error: no plates", tmp_path)
    assert compared_folders(refused, refused).equal
    assert not compared_folders(written(tmp_path / "old"), refused).equal


def test_tables_of_a_subject_are_known_by_their_names(tmp_path):
    text = 'mass = 70\n[[markers]]\nname = "KNE"\nposition = [0.1, 0.2, 0.3]\n'
    (tmp_path / "subject.toml").write_text(text, encoding="utf-8")
    found = numbers_in_folder(tmp_path)
    assert set(found) == {"subject.toml: mass", "subject.toml: markers.KNE.position"}


def test_captures_have_names_of_their_own_and_every_folder_is_used_or_left_out(real_data):
    names = [capture.name for capture in CAPTURES]
    assert len(set(names)) == len(names)
    words = " ".join(
        word for c in CAPTURES for words in (*c.prepare, (c.trial, *c.question)) for word in words
    )
    folders = {path.name for path in real_data.iterdir() if path.is_dir()}
    assert {name for name in folders if f"{{data}}/{name}" not in words} == set(LEFT_OUT)
    for word in {w for c in CAPTURES for words in c.prepare for w in (*words, *c.options, c.trial)}:
        if word.startswith("{data}"):
            assert Path(word.replace("{data}", str(real_data))).is_file(), word


def test_results_of_another_tree_are_not_taken(tmp_path):
    tree = Tree(tmp_path / "source", tmp_path / "out", tmp_path, cached=True)
    with pytest.raises(InvalidInput, match="no source tree"):
        tree.check()
    package = tree.source / "mbkf"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("", encoding="utf-8")
    tree.check()
    (package / "__init__.py").write_text("changed = True\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match="another source tree"):
        tree.check()


def test_wrong_usage_ends_with_2(tmp_path, capsys):
    assert main(["--old", str(tmp_path), "--data", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "no source tree" in capsys.readouterr().err
    assert main(["--old", str(tmp_path), "--data", str(tmp_path), "--only", "nothing"]) == 2


def test_a_nudge_moves_mass_and_positions_by_their_last_digit_and_nothing_else():
    text = 'height_m = 1.8\nmass_kg = 70.5\nname = "R.MT1"\nposition_m = [0.1, -0.2e-1, 0.0]\n'
    lines = nudged(text, np.inf).splitlines()
    assert lines[0::2] == ["height_m = 1.8", 'name = "R.MT1"']
    assert float(lines[1].split("=")[1]) == np.nextafter(70.5, np.inf)
    moved = json.loads(lines[3].split("=")[1])
    assert moved == [np.nextafter(x, np.inf) for x in (0.1, -0.02, 0.0)]


def test_a_difference_is_set_against_what_rounding_does():
    row = Row("c", "r", 4e-6, "a", 3, False, (Beyond("a", 4e-6, np.nan), Beyond("b", 3e-9, np.nan)))
    found = with_rounding(row, {"a": 2e-6, "b": 1e-12})
    assert found.times_rounding == pytest.approx(3.0)
    assert [array.rounding for array in found.beyond] == [2e-6, 1e-12]
    assert not found.passed


def test_a_name_chooses_one_capture_and_a_part_of_names_all_of_them():
    assert [capture.name for capture in _chosen(["gaitalytics"])] == ["gaitalytics"]
    assert [capture.name for capture in _chosen(["stoop"])] == [f"stoop_lift_{n}" for n in (1, 2, 3)]
    assert _chosen(None) == list(CAPTURES)
