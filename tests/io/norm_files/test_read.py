"""Files of norms are known by their content; tables have decimal commas, rows of units, and statements."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.read import read_foreign_norms
from tests.io.norm_files.made import (
    KNEE,
    KNEE_SD,
    MOMENT,
    MOMENT_SD,
    gcd_text,
    long_table,
    pinzone_sheet,
    pycgm2_text,
    wide_table,
    write_workbook,
)  # fmt: skip


@pytest.mark.parametrize(
    ("text", "form"),
    [
        (long_table(), "table"),
        (wide_table(), "table"),
        (pycgm2_text(), "data set of pyCGM2"),
        (gcd_text(), "GCD file"),
    ],
)
def test_the_knee_is_that_of_every_form(tmp_path, text, form):
    file = tmp_path / "norms.dat"
    file.write_text(text)
    found = read_foreign_norms(file)
    knee = next(band for band in found.bands if "nee" in band.label)
    assert found.form == form and knee.unit == "deg"
    np.testing.assert_allclose([knee.mean, knee.sd], [KNEE, KNEE_SD], atol=2e-6)


def test_statements_units_and_ends_of_a_wide_table(tmp_path):
    file = tmp_path / "n.csv"
    file.write_text(wide_table(), encoding="utf-8-sig")
    found = read_foreign_norms(file)
    assert found.statements == {
        "source": "Rossi 2019", "convention": "clinical", "persons": "30", "age": "20-40", "speed": "1.1-1.4",
    }  # fmt: skip
    moment = found.bands[1]
    assert (moment.label, moment.unit) == ("Hip extensor moment", "N m/kg")
    np.testing.assert_allclose([moment.mean, moment.sd], [MOMENT, MOMENT_SD], atol=2e-6)


def test_a_row_of_units_belongs_to_the_heads(tmp_path):
    file = tmp_path / "n.tsv"
    rows = ["percent\tKnee mean\tKnee sd", "%\trad\trad", *(f"{p}\t1.0\t0.1" for p in range(101))]
    file.write_text("\n".join(rows))
    (found,) = read_foreign_norms(file).bands
    assert (found.label, found.unit, len(found.mean)) == ("Knee", "rad", 101)


def test_workbooks_by_their_ending_and_other_files(tmp_path):
    made = write_workbook(tmp_path / "n.xlsx", {"Angles": pinzone_sheet()})
    assert read_foreign_norms(made).form == "workbook"
    (tmp_path / "x.csv").write_text("a,b\n1,2\n")
    with pytest.raises(FileFormatError, match="names no columns of per cent"):
        read_foreign_norms(tmp_path / "x.csv")
    with pytest.raises(FileFormatError, match="no such file"):
        read_foreign_norms(tmp_path / "gone.csv")
