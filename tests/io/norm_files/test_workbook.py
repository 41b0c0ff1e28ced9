"""Workbooks: cells at their places as texts; damaged and hostile ones are refused."""

import zipfile

import pytest

from mbkf.errors import FileFormatError
from mbkf.io.norm_files import workbook
from mbkf.io.norm_files.workbook import read_workbook
from tests.io.norm_files.made import write_workbook


def test_cells_come_back_at_their_places(tmp_path):
    sheets = {"One": [["a", "", "3"], [], ["", "-1.5"]], "Two": [["b"]]}
    assert read_workbook(write_workbook(tmp_path / "n.xlsx", sheets)) == sheets


@pytest.mark.parametrize(
    ("old", "new"),
    [('r="A1"', 'r="AAAA1"'), ('r="A1"', 'r="A99999999"'), ("<v>0</v>", "<v>7</v>"), ("</row>", "")],
)
def test_damaged_sheets_are_refused(tmp_path, old, new):
    made = write_workbook(tmp_path / "n.xlsx", {"One": [["a"]]})
    with zipfile.ZipFile(made) as book:
        parts = {name: book.read(name).decode() for name in book.namelist()}
    name = "xl/worksheets/sheet1.xml"
    assert old in parts[name]
    with zipfile.ZipFile(made, "w") as book:
        for key, text in parts.items():
            book.writestr(key, text.replace(old, new) if key == name else text)
    with pytest.raises(FileFormatError, match=r"no workbook that can be read"):
        read_workbook(made)


def test_other_files_and_huge_parts_are_refused(tmp_path, monkeypatch):
    (tmp_path / "x.xlsx").write_text("percent,mean,sd")
    with pytest.raises(FileFormatError, match=r"save it as \.xlsx again"):
        read_workbook(tmp_path / "x.xlsx")
    monkeypatch.setattr(workbook, "MOST_BYTES", 100)
    with pytest.raises(FileFormatError, match="larger than"):
        read_workbook(write_workbook(tmp_path / "n.xlsx", {"One": [["a"]]}))
