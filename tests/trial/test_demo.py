"""The demo's chain on a short squat: files, and errors that a correct chain stays below."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.trial.demo import COORDINATES, Demo, run_demo

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Demo:
    """A squat of a second and a half by the first synthetic person."""
    return run_demo("squat", tmp_path_factory.mktemp("demo"), seconds=1.5, seed=0)


def test_the_capture_and_the_result_are_on_disk(demo: Demo) -> None:
    """Everything the command line's contract names."""
    capture = {path.name for path in demo.folder.iterdir()}
    result = {path.name for path in (demo.folder / "result").iterdir()}
    assert {"trial.c3d", "raw.c3d", "static.c3d", "subject.toml", "truth.h5"} <= capture
    assert result == {
        "summary.json",
        "motion.h5",
        "angles.mot",
        "angles_lab.mot",
        "torques.sto",
        "reactions.mot",
        "markers.trc",
    }


def test_it_starts_from_points_without_names(demo: Demo) -> None:
    """The reconstruction is that of the labelled file, whose names are right."""
    assert demo.result.trial == "labelled"
    assert (demo.folder / "labelled.json").is_file()
    assert demo.labels["correct_fraction"] >= 0.998
    assert demo.labels["wrong_fraction"] <= 0.001
    assert demo.labels["ghosts_dropped"] > 0


def test_leg_angles_follow_the_truth(demo: Demo) -> None:
    """3 mm of skin movement on levers of 0.2 m and more is below two degrees in hip, knee and ankle."""
    assert tuple(error.name for error in demo.errors) == COORDINATES
    legs = [error.angle_rms for error in demo.errors if error.name.startswith(("hip", "knee", "ankle"))]
    assert np.rad2deg(max(legs)) < 2.0


def test_reactions_and_markers_are_those_measured(demo: Demo) -> None:
    """All frames stand on plates, and markers fit to about the skin's movement."""
    assert demo.summary["valid_frames"] == demo.summary["frames"]
    assert demo.summary["marker_rms_mm"] < 3.0 * np.sqrt(3)
    assert demo.summary["truth"]["reaction_rms_n"] < 10.0


def test_a_file_in_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    """Before anything is computed."""
    target = tmp_path / "taken"
    target.write_text("mine")
    with pytest.raises(FileFormatError):
        run_demo("squat", target)
    assert target.read_text() == "mine"
