"""CSV tables of people: delimiters, titles and rows of spreadsheets are read; a wrong row is only its own fault."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError, UnknownEntry
from mbkf.io import fields
from mbkf.io.edited_csv import read_edited_csv

NAME = fields.text("name", "a name", required=True)
MASS = fields.number("mass_kg", "a mass", (0.5, 500.0), "kg")
LIST = fields.record("list", NAME, MASS)


def rows(folder, text):
    file = folder / "list.csv"
    file.write_bytes(text.encode("utf-8"))
    return read_edited_csv(file, LIST)


@given(
    st.lists(st.tuples(st.text("ab ;,\t\"'", min_size=1), st.integers(1, 400)), min_size=1, max_size=4),
    st.sampled_from([",", ";", "\t"]),
    st.sampled_from(["\n", "\r\n"]),
    st.booleans(),
)
def test_cells_come_back_with_every_delimiter_and_end_of_line(
    tmp_path_factory, cells, delimiter, end, marked
):
    quoted = ['"{}"'.format(name.replace('"', '""')) for name, _ in cells]
    lines = [
        f"Name{delimiter}Mass (kg)",
        *(f"{q}{delimiter}{m}" for q, (_, m) in zip(quoted, cells, strict=True)),
    ]
    found = rows(tmp_path_factory.mktemp("csv"), "\ufeff" * marked + end.join(lines) + end)
    assert [row.cells.get("name", "") for row in found] == [name.strip() for name, _ in cells]
    assert [row.line for row in found] == list(range(2, len(cells) + 2))
    for row, (name, mass) in zip(found, cells, strict=True):
        assert row.notes == ()
        if not isinstance(row.entries, FileFormatError) and name.strip():
            assert (row.entries.need(NAME), row.entries.get(MASS)) == (name.strip(), float(mass))


def test_lines_count_rows_of_several_lines_and_blank_ones(tmp_path):
    found = rows(tmp_path, 'sep=;\n\nname;mass_kg\n"a\nb";1\n;\nc;x\n')
    assert [row.line for row in found] == [4, 7]
    with pytest.raises(FileFormatError, match=r"line 7: mass_kg must be .*, got x"):
        found[1].entries.get(MASS)


def test_only_ends_of_line_end_a_row(tmp_path):
    first, second = rows(tmp_path, "name,mass_kg\ra\u2028b,1\rc,2\r")
    assert (first.cells["name"], second.cells["name"], second.line) == ("a\u2028b", "c", 3)


def test_a_row_with_more_cells_is_its_own_fault(tmp_path):
    first, second = rows(tmp_path, "name,mass_kg\na,71,9\nb,72\n")
    assert isinstance(first.entries, FileFormatError) and "3 cells for 2 columns" in str(first.entries)
    assert second.entries.get(MASS) == 72.0


@pytest.mark.parametrize(
    ("text", "error", "reason"),
    [
        ("name,weight\n", UnknownEntry, "line 1: unknown list column 'weight'"),
        ("mass_kg\n1\n", FileFormatError, "has no column 'name'"),
        ("name,NAME\n", FileFormatError, "column name stands twice"),
        ('name,mass_kg\n"' + "x" * 200_000 + "\n", FileFormatError, "is damaged"),
    ],
)
def test_tables_that_cannot_be_are_refused(tmp_path, text, error, reason):
    with pytest.raises(error, match=reason):
        rows(tmp_path, text)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(FileFormatError, match="cannot be read as a list in CSV"):
        read_edited_csv(tmp_path / "none.csv", LIST)


@pytest.mark.parametrize("text", ["", "\n\n", ";;\n", "sep=;\n"])
def test_an_empty_table_has_no_rows(tmp_path, text):
    assert rows(tmp_path, text) == []
