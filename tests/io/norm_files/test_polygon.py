"""Workbooks: Polygon's pairs of columns, and sheets with a table each."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.polygon import workbook_norms
from tests.io.norm_files.made import KNEE, KNEE_SD, pinzone_sheet, polygon_sheet


def test_two_columns_of_one_head_are_the_ends_of_a_band(tmp_path):
    (band,) = workbook_norms(tmp_path, {"Normal": polygon_sheet()}).bands
    assert (band.label, band.component, band.unit) == ("KneeAngles", "X", "deg")
    np.testing.assert_allclose([band.mean, band.sd], [KNEE, KNEE_SD], atol=1e-6)


def test_tables_of_all_sheets_count(tmp_path):
    found = workbook_norms(tmp_path, {"Guide": [["read me"]], "Empty": [], "Angles": pinzone_sheet()})
    assert found.groups == ("CentreOne", "CentreTwo") and {band.quantity for band in found.bands} == {"angle"}
    np.testing.assert_allclose(found.bands[1].mean, KNEE + 3.0)


@pytest.mark.parametrize("sheets", [{"Sheet1": [["a", "b"]]}, {"Normal": [["KneeAngles (1)"]]}])
def test_workbooks_without_bands_are_refused(tmp_path, sheets):
    with pytest.raises(FileFormatError, match=r"no sheet has|no values below"):
        workbook_norms(tmp_path, sheets)
