"""pyCGM2's data sets: groups, components, mean between both ends; zeros are no curve."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.pycgm2 import pycgm2_norms
from tests.io.norm_files.made import KNEE, KNEE_SD, MOMENT_SD, PERCENT, pycgm2_text


def test_bands_are_between_both_ends(tmp_path):
    found = pycgm2_norms(tmp_path, pycgm2_text())
    assert found.groups == ("Free", "Slow")
    assert [(b.label, b.component, b.unit) for b in found.bands[:3]] == [
        ("KneeAngles", "X", "deg"), ("HipMoment", "X", "N mm/kg"), ("WristAngles", "X", "deg"),
    ]  # fmt: skip
    np.testing.assert_allclose(
        [found.bands[0].mean, found.bands[0].sd, found.bands[0].percent], [KNEE, KNEE_SD, PERCENT]
    )
    np.testing.assert_allclose(found.bands[1].sd, 1e3 * MOMENT_SD)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "damaged JSON"),
        ("[1]", "no data set"),
        ('{"a": {}, "b": {}}', "no data set"),
        ('{"a": {"Free": {"KneeAngles": {"X": [[0, 1]]}}}}', "Free, KneeAngles, X: three numbers"),
        ('{"a": {"Free": {"KneeAngles": {"X": [[0, 1, "x"]]}}}}', "three numbers"),
    ],
)
def test_other_json_is_refused(tmp_path, text, message):
    with pytest.raises(FileFormatError, match=message):
        pycgm2_norms(tmp_path, text)
