"""Names that the filter took up are those of the whole trial in each of its pieces."""

import numpy as np
import pytest

from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.records import MarkerTrajectories
from mbkf.trial.long.assembly import in_piece
from mbkf.trial.preparation.exchanged import renamed_by_filter


@pytest.mark.parametrize("begin", [0, 20, 45])
def test_a_piece_is_renamed_as_the_whole(begin):
    rate_hz, positions = 100.0, np.random.default_rng(1).normal(size=(60, 3, 3))
    exchanged = LimbDoubt("left_thigh", "turned over", 0.3, 0.4, exchanged=(("A", "C"),), right_from_s=0.35)
    doubts = (exchanged, LimbDoubt("right_thigh", "fits badly", 0.1, 0.4))
    whole, _ = renamed_by_filter(MarkerTrajectories(("A", "B", "C"), positions, rate_hz), doubts)
    piece = MarkerTrajectories(("A", "B", "C"), positions[begin:], rate_hz, begin / rate_hz)
    found, _ = renamed_by_filter(piece, [in_piece(one, begin / rate_hz) for one in doubts])
    np.testing.assert_array_equal(found.positions_m, whole.positions_m[begin:])
    assert (whole.positions_m[35:, 0] == positions[35:, 2]).all()
