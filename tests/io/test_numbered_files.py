"""Files of one trial that hold a numbered plate each."""

import re

import pytest

from mbkf.io.numbered_files import numbered_files, plate_files

NAME = re.compile(r"(?P<trial>.*)_f_(?P<plate>\d+)")


@pytest.fixture
def folder(tmp_path):
    for name in ("a.tsv", "a_f_10.tsv", "a_f_2.tsv", "a_f_1.csv", "b_f_1.tsv"):
        (tmp_path / name).touch()
    return tmp_path


def test_plates_of_the_trial_in_the_order_of_their_numbers(folder):
    expected = (folder / "a_f_2.tsv", folder / "a_f_10.tsv")
    assert plate_files(folder / "a.tsv", NAME) == plate_files(folder / "a_f_10.tsv", NAME) == expected
    assert plate_files(folder / "none" / "a.tsv", NAME) == ()


def test_files_read_together_are_named_and_a_missing_one_stays_alone(folder):
    notes = []
    assert len(numbered_files(folder / "a_f_2.tsv", NAME, notes)) == 2
    assert notes == ["plates of one trial were read together: a_f_2.tsv, a_f_10.tsv"]
    assert numbered_files(folder / "a_f_3.tsv", NAME, notes) == (folder / "a_f_3.tsv",)
    assert numbered_files(folder / "b_f_1.tsv", NAME, notes) == (folder / "b_f_1.tsv",)
    assert numbered_files(folder / "c.tsv", NAME, notes) == (folder / "c.tsv",)
    assert len(notes) == 1
