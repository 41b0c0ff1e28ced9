"""Declared entries: cells of people, mends of wrong numbers, rows of the documentation."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.io import fields

MASS = fields.number("mass_kg", "body mass", (0.5, 500.0), "kg")
HEIGHT = fields.number("height_m", "body height", (0.3, 2.8), "m", required=True)
NAME = fields.text("name", "a name")
WIDE = fields.number("x", "a wide number", (0.0, 1e6), "m")


@pytest.mark.parametrize(
    ("cell", "value"),
    [("71.9", 71.9), ("71", 71.0), ("7.19e1", 71.9), ("+71.9", 71.9)],
)
def test_a_number_as_programs_write_it_needs_no_note(cell, value):
    assert MASS.of_cell(cell) == (value, "")


@pytest.mark.parametrize(
    ("field", "cell", "value"),
    [(MASS, "71,9", 71.9), (MASS, "71.9 kg", 71.9), (MASS, "71,9kg", 71.9), (HEIGHT, "1,780", 1.78)],
)
def test_a_decimal_comma_or_the_own_unit_is_read_with_a_note(field, cell, value):
    found, note = field.of_cell(cell)
    assert found == value and note == f"{field.key} '{cell}' is read as {value:g} {field.unit}"


@pytest.mark.parametrize(
    ("field", "cell"),
    [
        (MASS, "heavy"), (MASS, "#REF!"), (MASS, "1.234,5"), (MASS, "7_1"), (MASS, "158 lb"), (MASS, "71,9,1"),
        (MASS, "nan"), (MASS, "inf"), (MASS, "\u0667\u0661"), (WIDE, "1,234"), (HEIGHT, "178 cm"), (MASS, ""),
    ],
)  # fmt: skip
def test_other_cells_stay_texts_that_no_number_accepts(field, cell):
    found, note = field.of_cell(cell)
    assert found == cell and note == "" and field.parse(found) is None


@pytest.mark.parametrize(
    ("field", "value", "mend"),
    [
        (MASS, "71,9", "; write mass_kg = 71.9"),
        (MASS, "158 lb", "; write mass_kg = 71.67"),
        (MASS, 71900, "; write mass_kg = 71.9 if it is in g"),
        (HEIGHT, "178 cm", "; write height_m = 1.78"),
        (HEIGHT, "6 ft", "; write height_m = 1.829"),
        (HEIGHT, 178, "; write height_m = 1.78 if it is in cm"),
        (HEIGHT, -1.7, ""),
        (HEIGHT, "tall", ""),
        (HEIGHT, True, ""),
        (MASS, float("nan"), ""),
        (NAME, 3, ""),
    ],
)
def test_a_mend_is_given_where_one_number_is_meant(field, value, mend):
    assert field.mend(value) == mend


@given(st.floats(0.5, 500.0))
def test_every_number_written_with_a_comma_is_the_same_number(value):
    text = f"{value:.4f}"
    found, note = MASS.of_cell(text.replace(".", ","))
    assert found == float(text) and note


def test_rows_of_the_documentation_say_value_and_need():
    assert fields.record("person", MASS, HEIGHT, NAME).rows() == [
        "| `mass_kg` | a number between 0.5 and 500 kg | body mass |",
        "| `height_m` | a number between 0.3 and 2.8 m (required) | body height |",
        "| `name` | a text | a name |",
    ]


@pytest.mark.parametrize("value", [True, "x", None, [1.0], float("inf"), 10**400])
def test_no_number_is_made_of_other_values(value):
    assert MASS.parse(value) is None
