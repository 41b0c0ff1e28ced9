"""A laboratory's file: what is written comes back with its logo, and what is no picture is refused."""

from dataclasses import replace

import pytest

from mbkf.errors import FileFormatError
from mbkf.io.laboratory import (
    LABORATORY_FILE,
    MOST_LOGO,
    Laboratory,
    laboratory_above,
    read_laboratory,
    write_laboratory,
)

PNG = b"\x89PNG\r\n\x1a\n" + b"\0" * 8
OURS = Laboratory("Gait laboratory", "1 Road\nTown", PNG, "image/png", ("Speed", "Step length"))


@pytest.mark.parametrize(
    "one", [OURS, Laboratory(), Laboratory("A", logo=b"\xff\xd8\xff", media_type="image/jpeg")]
)
def test_what_is_written_comes_back(tmp_path, one):
    write_laboratory(one, tmp_path)
    write_laboratory(one, tmp_path)
    found = read_laboratory(tmp_path / LABORATORY_FILE)
    assert replace(found, logo_file="") == one and bool(found.logo_file) == bool(one.logo)


def test_comments_and_the_own_picture_stay(tmp_path):
    file = tmp_path / LABORATORY_FILE
    file.write_text("# Ours.\nname = 'A'  # for letters\nlogo = 'ours.png'\n")
    (tmp_path / "ours.png").write_bytes(PNG)
    write_laboratory(replace(read_laboratory(file), address="1 Road"), tmp_path)
    assert file.read_text().startswith("# Ours.\nname = 'A'  # for letters\nlogo = 'ours.png'\n")
    assert read_laboratory(file) == Laboratory("A", "1 Road", PNG, "image/png", logo_file="ours.png")
    assert [one.name for one in tmp_path.glob("*.png")] == ["ours.png"]


def test_the_first_folder_with_a_file_counts(tmp_path):
    inner = tmp_path / "results" / "P1"
    inner.mkdir(parents=True)
    assert laboratory_above([inner, tmp_path]) == Laboratory()
    write_laboratory(OURS, tmp_path)
    assert laboratory_above([inner, *inner.parents]) == replace(OURS, logo_file="logo-d9c9bcbb.png")
    write_laboratory(Laboratory("nearer"), inner)
    assert laboratory_above([inner, *inner.parents]).name == "nearer"


@pytest.mark.parametrize(
    ("text", "content", "fragment"),
    [
        ("nam = 'x'", b"", "unknown laboratory entry 'nam'; did you mean name"),
        ("logo = '../logo.png'", PNG, "logo must be the name of a picture beside this file"),
        ("logo = 'other.png'", PNG, "the logo other.png is not beside this file"),
        ("logo = 'logo.png'", b"<svg/>", "no picture; the logo must be PNG or JPEG"),
        ("logo = 'logo.png'", PNG + b"\0" * MOST_LOGO, "logo.png"),
        ("trend = 'Speed'", b"", "trend must be a list of texts"),
    ],
)
def test_what_is_not_possible_is_refused(tmp_path, text, content, fragment):
    (tmp_path / LABORATORY_FILE).write_text(text)
    (tmp_path / "logo.png").write_bytes(content)
    with pytest.raises(FileFormatError) as told:
        read_laboratory(tmp_path / LABORATORY_FILE)
    assert fragment in str(told.value)
