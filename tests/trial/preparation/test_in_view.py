"""A second person in view: repeated names, markers out of reach, and markers that are the subject's after all."""

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.trial.preparation.in_view import FAR_M, LEAST_MARKERS, far_points, others_in_view

OWN = ("LASI", "RASI", "LPSI", "RPSI", "LKNE", "RKNE")
FRAMES = 130


def walking(offset_m=(0.0, 0.0, 0.0)):
    """(T, 6, 3) markers that travel, at places within half a metre."""
    places = np.random.default_rng(1).uniform(0.0, 0.5, (6, 3)) + offset_m
    return places + np.linspace(0.0, 4.0, FRAMES)[:, None, None] * [1.0, 0.0, 0.0]


def seen(*groups):
    names = tuple(name for names, _ in groups for name in names)
    return MarkerTrajectories(names, np.concatenate([places for _, places in groups], axis=1), 100.0)


@pytest.mark.parametrize("write", ["B:{}", "{}_2"])
def test_markers_of_the_same_names_elsewhere_are_a_second_person(write):
    beside = tuple(write.format(name) for name in OWN)
    near = others_in_view(seen((OWN, walking()), (beside, walking((0.4, 0.0, 0.0)))), OWN)
    assert near.names == beside and near.is_person
    copied = others_in_view(seen((OWN, walking()), (beside, walking((0.05, 0.0, 0.0)))), OWN)
    assert copied.names == (), "a copy of a marker lies at its place"


def test_markers_without_a_known_name_count_where_no_marker_of_the_subject_is_near():
    other = tuple(f"*{n}" for n in range(LEAST_MARKERS))
    far = others_in_view(seen((OWN, walking()), (other, walking((0.0, 2.0, 0.0)))), OWN)
    assert far.is_person and far.far_m == pytest.approx(2.0, abs=0.5)
    assert f"{LEAST_MARKERS} markers" in far.sentence and "*0" in far.sentence
    assert others_in_view(seen((OWN, walking()), (other, walking((0.0, 0.4, 0.0)))), OWN).names == ()


def test_a_frame_of_five_markers_is_no_person():
    frame = tuple(f"frame{n}" for n in range(5))
    found = others_in_view(seen((OWN, walking()), (frame, walking((0.0, 2.0, 0.0))[:, :5])), OWN)
    assert len(found.names) == 5 and not found.is_person


def test_a_marker_that_passes_for_a_moment_is_not_far():
    places = walking()
    away = np.where(np.arange(FRAMES)[:, None, None] < 20, [5.0, 0.0, 0.0], 0.1)
    other = tuple(f"*{n}" for n in range(6))
    assert others_in_view(seen((OWN, places), (other, places + away)), OWN).names == ()


def test_points_in_any_order_are_counted_frame_by_frame():
    rng, own, points = np.random.default_rng(2), walking(), walking((0.0, FAR_M + 0.6, 0.0))
    shuffled = np.array([rng.permutation(frame) for frame in points])
    assert far_points(shuffled, own) == 6 and far_points(own + 0.1, own) == 0
    assert (
        far_points(np.full_like(points, np.nan), own) == 0
        and far_points(points, np.full_like(own, np.nan)) == 0
    )
