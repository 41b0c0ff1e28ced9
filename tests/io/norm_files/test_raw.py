"""Groups of a file's bands, in order."""

import numpy as np

from mbkf.io.norm_files.raw import RawBand, RawNorms


def test_groups_stand_in_the_files_order_once():
    bands = [
        RawBand("a", np.zeros(2), np.ones(2), np.zeros(2), group=name) for name in ("Slow", "Free", "Slow")
    ]
    assert RawNorms("table", tuple(bands)).groups == ("Slow", "Free")
    assert RawNorms("table", (RawBand("a", np.zeros(2), np.ones(2), np.zeros(2)),)).groups == ("",)
