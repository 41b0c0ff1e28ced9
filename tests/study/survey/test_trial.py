"""What is the matter with a capture is told, and what to do about it."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.c3d_write import write_c3d
from mbkf.io.session import TrialKind
from mbkf.study.survey.trial import standing_mass, survey_trial
from tests.studies import walk_folder


def test_a_walk_and_its_standing_trial():
    walk, static = (survey_trial(walk_folder() / name) for name in ("trial.c3d", "static.c3d"))
    assert (walk.kind, static.kind) == (TrialKind.WALK, TrialKind.STATIC)
    assert walk.seconds == pytest.approx(2.5, abs=0.02) and walk.rate_hz == 100.0
    assert (walk.name, walk.protocol, walk.unnamed) == ("trial", "reference36", 0)
    assert walk.usable and walk.plates == 6 and walk.problems == ()


def test_points_without_names_are_told_and_files_that_cannot_be_read_are_grave(tmp_path):
    raw = survey_trial(walk_folder() / "raw.c3d")
    assert raw.usable and raw.markers == 0 and "no names" in raw.problems[0].what
    (tmp_path / "bad.c3d").write_bytes(b"nothing")
    (tmp_path / "folder.c3d").mkdir()
    for name in ("bad.c3d", "folder.c3d", "missing.c3d"):
        bad = survey_trial(tmp_path / name)
        assert not bad.usable and bad.problems[0].what.startswith("cannot be read") and bad.problems[0].todo


def test_no_marker_gaps_unknown_names_and_no_plate_are_told(tmp_path):
    from mbkf.io.capture import read_capture

    made = read_capture(walk_folder() / "trial.c3d")
    markers = made.markers
    some = np.array(markers.positions_m)
    some[: len(some) // 2] = np.nan
    strange = tuple(f"Q{k}" for k in range(len(markers.names)))
    cases = {
        "none": (
            replace(markers, positions_m=np.full_like(some, np.nan)),
            made.plates,
            "no markers are visible",
        ),
        "half": (replace(markers, positions_m=some), made.plates, "51 % of the marker samples are missing"),
        "names": (replace(markers, names=strange), made.plates, "marker set is not known"),
        "plates": (markers, (), "no force plate"),
    }
    for name, (changed, plates, told) in cases.items():
        write_c3d(replace(made, markers=changed, plates=plates), tmp_path / f"{name}.c3d")
        found = survey_trial(tmp_path / f"{name}.c3d")
        assert any(told in problem.what for problem in found.problems), (name, found.problems)
        assert found.usable == (name != "none")


def test_plates_weigh_who_stands_on_them(capture_of_weight=71.0):
    from mbkf.io.capture import read_capture

    made = read_capture(walk_folder() / "trial.c3d")
    plate = made.plates[0]
    half = np.zeros_like(plate.force_n)
    half[:, 2] = 0.5 * 9.80665 * capture_of_weight
    plates = (replace(plate, force_n=half), replace(plate, force_n=half))
    assert standing_mass(replace(made, plates=plates)) == pytest.approx(capture_of_weight, rel=1e-3)
    assert standing_mass(replace(made, plates=())) is None
    half[::2, 2] *= 0.5
    assert standing_mass(replace(made, plates=(replace(plate, force_n=half),))) is None
