"""Name, mass and height of a C3D file's person; a file that states nothing, or is damaged, has none."""

import pytest

from mbkf.io.c3d_person import StatedPerson, person_of_c3d
from tests.io.c3d_builder import build_c3d


def test_name_mass_and_height_are_read(tmp_path):
    extra = {
        ("SUBJECTS", "NAMES"): ["HC032A"], ("PROCESSING", "Bodymass"): 60.5, ("PROCESSING", "Height"): 1580.0,
    }  # fmt: skip

    assert person_of_c3d(build_c3d(tmp_path / "a.c3d", extra=extra)) == StatedPerson(("HC032A",), 60.5, 1.58)


@pytest.mark.parametrize("height, read", [(1.75, 1.75), (1750.0, 1.75), (0.0, None), (175.0, None)])
def test_heights_stand_in_metres_or_millimetres(tmp_path, height, read):
    found = person_of_c3d(build_c3d(tmp_path / "a.c3d", extra={("SUBJECTS", "HEIGHT"): height}))
    assert found == StatedPerson(height_m=read)


def test_a_changed_file_is_read_again(tmp_path):
    file = tmp_path / "a.c3d"
    for name in ("Anna", "Benjamin"):
        build_c3d(file, extra={("SUBJECTS", "NAMES"): [name], ("SUBJECTS", "SETS"): [name] * 300})
        assert person_of_c3d(file).names == (name,)


def test_other_files_state_no_person(tmp_path):
    (tmp_path / "a.c3d").write_bytes(b"nothing")
    (tmp_path / "a.trc").write_text("PathFileType 4", encoding="utf-8")
    for name in ("a.c3d", "a.trc", "missing.c3d"):
        assert person_of_c3d(tmp_path / name) == StatedPerson()
