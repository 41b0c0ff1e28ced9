"""GCD files: a variable's rows are mean and spread; parameters of one row stay outside."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.gcd import gcd_norms
from tests.io.norm_files.made import KNEE, KNEE_SD, PERCENT, gcd_text


def test_variables_are_curves(tmp_path):
    found = gcd_norms(tmp_path, gcd_text())
    assert [(b.label, b.unit) for b in found.bands] == [
        ("KneeFlexExt", "deg"),
        ("HipFlexExtMoment", "N m/kg"),
    ]
    np.testing.assert_allclose([found.bands[0].mean, found.bands[0].sd], [KNEE, KNEE_SD], atol=1e-6)
    np.testing.assert_array_equal(found.bands[0].percent, PERCENT)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("!A 1\n1 2 3\n", "line 2: 3 numbers"),
        ("!A 1\n1 x\n", "line 2: not a number"),
        ("!A\n1 2\n!A\n", "A stands twice"),
    ],
)
def test_damaged_rows_are_named(tmp_path, text, message):
    with pytest.raises(FileFormatError, match=message):
        gcd_norms(tmp_path, text)
