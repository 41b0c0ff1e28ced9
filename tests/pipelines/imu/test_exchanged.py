"""Which pairs may be exchanged, and that the misfit of right names is the least."""

import numpy as np

from mbkf.pipelines.imu.exchanged import Exchange, exchanged, likely
from tests.worn import worn


def test_pairs_are_sides_and_neighbours_that_carry_sensors():
    model = worn().model
    found = list(likely(model, ("pelvis", "right_thigh", "left_thigh", "right_shank")))
    assert set(found) == {("right_thigh", "left_thigh"), ("right_thigh", "right_shank")}


def test_no_exchange_is_told_where_no_filter_fits(monkeypatch):
    from mbkf.pipelines.imu import exchanged as module

    misfits = iter([np.inf, 1.0, 1.0])
    monkeypatch.setattr(module, "misfit", lambda *_: next(misfits))
    segments = ("right_thigh", "left_thigh", "right_shank")
    assert exchanged(worn().model, segments, lambda _: (None, None)) is None


def test_the_least_misfit_is_told_where_it_is_clearly_less(monkeypatch):
    from mbkf.pipelines.imu import exchanged as module

    segments = ("right_thigh", "left_thigh", "right_shank")
    for misfits, expected in (([1.0, 0.2, 0.5], 0.2), ([1.0, 0.9, 0.7], None)):
        left = iter(misfits)
        monkeypatch.setattr(module, "misfit", lambda *_, left=left: next(left))
        found = exchanged(worn().model, segments, lambda _: (None, None))
        assert (found is None) if expected is None else found == Exchange(("right_thigh", "left_thigh"), 0.2)
        assert found is None or "20 %" in found.told
