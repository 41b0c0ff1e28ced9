"""The folder of a synthetic capture: complete, repeatable, told of as it goes."""

import pytest

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.subject import read_subject
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.synth import FILES, synthesise, write_folder

pytestmark = pytest.mark.slow


def test_folder_is_complete_and_the_subject_exact(tmp_path):
    told = []
    subject, capture = synthesise("squat", seconds=1.2, seed=2, progress=lambda *stage: told.append(stage))
    paths = write_folder(subject, capture, tmp_path / "out")
    assert [path.name for path in paths] == list(FILES)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(FILES)
    back = read_subject(tmp_path / "out" / "subject.toml")
    assert back.scale_factors == subject.scale_factors
    assert back.mass_kg == subject.mass_kg
    assert told[-1][1] == told[-1][2]


def test_a_given_subject_moves():
    person = synthesise_subject(4, height_m=1.62, mass_kg=55.0)
    subject, capture = synthesise("squat", seconds=1.2, seed=2, subject=person)
    assert subject is person
    assert capture.trial.subject_mass_kg == 55.0


def test_unknown_motion_is_refused():
    with pytest.raises(UnknownName, match="dance"):
        synthesise("dance")


def test_a_file_is_no_folder(tmp_path):
    subject, capture = synthesise("squat", seconds=1.2, seed=2)
    (tmp_path / "file").write_text("x")
    for path in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(FileFormatError, match="name another folder"):
            write_folder(subject, capture, path)
    assert (tmp_path / "file").read_text() == "x"
