"""Pieces of HTML: texts are escaped, structure is as asked."""

from xml.etree import ElementTree as ET

from mbkf.viz.markup import folded, grid, key, paragraph, section, table


def test_texts_are_escaped():
    for piece in (
        paragraph("a < b"),
        section("s", "a < b"),
        table(("a < b",), []),
        folded("a < b"),
        key(("x", "a < b")),
    ):
        assert "a &lt; b" in piece


def test_tables_have_a_row_for_each():
    root = ET.fromstring(table(("name", "value"), [("a", "1"), ("b", "<2>")], "small"))
    cells = [[cell.text for cell in row] for row in root.find("tbody")]
    assert cells == [["a", "1"], ["b", "<2>"]]


def test_a_grid_keeps_empty_places():
    root = ET.fromstring(grid(["<svg/>", "", ""], columns=3))
    assert [len(cell) for cell in root] == [1, 0, 0]
