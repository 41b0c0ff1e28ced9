"""Axes of captures without a known marker set: put right by names, or by where a body stands."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.axes import axes_matrix
from mbkf.io.capture import read_capture
from mbkf.io.records import AxesSource, Capture
from mbkf.io.turning import turned
from mbkf.marker_sets.names import NamedPlace, NameReading, read_names
from mbkf.model.body_file import load_body
from mbkf.trial.protocol.upright import SURE_NAME, known_places, upright_captures
from tests.marker_sets.worn import standing

BODY = load_body()
ON_ITS_BACK = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Up becomes −x, forward becomes up."""
HEAD_DOWN = np.diag([1.0, -1.0, -1.0])
MIRROR = np.diag([1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def capture():
    return Capture("static.trc", standing("plug_in_gait", 1).markers)


def misread(capture, turn, source=AxesSource.DEFAULT):
    """A capture as a reader gives it that does not know of the turn."""
    return replace(turned(capture, turn, source), axes="x,y,z", up_axis="z")


def nameless(capture):
    names = tuple(f"M{k}" for k in range(len(capture.markers.names)))
    return replace(capture, markers=replace(capture.markers, names=names))


def whole(found, turn):
    """(3, 3) what turns the true capture into what was found of it, by the axes that it tells."""
    return axes_matrix(found.axes) @ turn


def readings(capture):
    return read_names(capture.markers.names)


@pytest.mark.parametrize("turn", [ON_ITS_BACK, HEAD_DOWN, MIRROR, MIRROR @ ON_ITS_BACK])
def test_names_put_wrong_up_axes_and_mirror_images_right(capture, turn):
    (found,) = upright_captures([misread(capture, turn)], readings(capture), BODY)
    done = whole(found, turn)
    assert np.linalg.det(done) == pytest.approx(1.0)
    assert done[2, 2] == pytest.approx(1.0)
    np.testing.assert_allclose(found.markers.positions_m, capture.markers.positions_m @ done.T, atol=1e-9)
    assert "put right" in found.notes[-1] or "mirrored" in found.notes[-1]


@pytest.mark.parametrize("turn", [ON_ITS_BACK, HEAD_DOWN])
def test_without_names_up_is_where_a_body_stands(capture, turn):
    (found,) = upright_captures([nameless(misread(capture, turn))], {}, BODY)
    done = whole(found, turn)
    assert done[2, 2] == pytest.approx(1.0)
    assert np.linalg.det(done) == pytest.approx(1.0)
    assert "only then does a body stand upright" in found.notes[-1]


def test_right_axes_stay(capture):
    for one, names in ((capture, readings(capture)), (nameless(capture), {})):
        (found,) = upright_captures([one], names, BODY)
        assert found is one


def test_axes_that_were_given_are_not_overruled_by_a_body_without_names(capture):
    lying = nameless(misread(capture, ON_ITS_BACK, AxesSource.GIVEN))
    (found,) = upright_captures([lying], {}, BODY)
    assert found is lying


def test_a_trial_that_tells_nothing_follows_the_one_that_does(capture):
    """Of the second only six markers are seen, too few for anything but the first one's axes."""
    lying = misread(capture, ON_ITS_BACK)
    names = readings(capture)
    few = replace(lying, markers=lying.markers.select(lying.markers.names[:3]))
    first, second = upright_captures([lying, few], names, BODY)
    np.testing.assert_array_equal(axes_matrix(first.axes), axes_matrix(second.axes))


def test_only_sure_landmarks_are_known_places():
    def reading(probability, landmark="right_asis", segment="pelvis"):
        return NameReading("x", (NamedPlace(segment, landmark, probability),), "marker", "right")

    read = {
        "sure": reading(SURE_NAME),
        "unsure": reading(SURE_NAME - 0.01),
        "nowhere": reading(1.0, ""),
        "unknown": NameReading("unknown", (), "unknown", ""),
    }
    known = known_places(read, BODY)
    assert list(known) == ["sure"]
    np.testing.assert_array_equal(known["sure"].position_m, BODY.landmark("right_asis").position_m)
    assert known["sure"].segment == "pelvis"


def test_a_person_whose_axes_are_unclear_takes_those_of_the_other_in_the_file(real_data):
    """The file says y; both stand along z, and only the second one's points show it."""
    path = real_data / "two_persons_art" / "ART-Human_2persons_integer.c3d"
    chosen = read_capture(path, person="Human1")
    readings = read_names(chosen.markers.names)
    (found,) = upright_captures([chosen], readings, BODY)
    assert found.axes == "x,y,z"
    (alone,) = upright_captures([replace(chosen, others=None)], readings, BODY)
    assert alone.axes == chosen.axes == "x,-z,y"
