"""Marker sets inferred of synthetic persons: whole and partial, standing and walking, turned, mirrored, with names."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mbkf.errors import NotObservable
from mbkf.marker_sets.inference import OTHER_NAME, infer_markers, name_factors, place_log_density
from mbkf.marker_sets.names import NamedPlace, NameReading
from mbkf.marker_sets.places import worn_places
from mbkf.model.body_file import load_body
from tests.marker_sets.worn import BOX_M, box_at, near, standing, walking

BODY = load_body()
PLACES = worn_places(BODY)
SET = "plug_in_gait"
ARMS, LEGS, HEAD = ("upper_arm", "forearm", "hand"), ("thigh", "shank", "foot", "toes"), ("head", "neck")


def inferred(worn, *moving, readings=None, leave_out=(SET,)):
    """Of a static with names hidden, the protocol withheld."""
    static = [] if worn is None else [worn.markers]
    return infer_markers(static, [one.markers for one in moving], readings or {}, BODY, leave_out)


def told(segment, landmark="", probability=0.95):
    return NameReading("", (NamedPlace(segment, landmark, probability),), "marker", "")


def probability_of(found, name, segment):
    """Of a segment by what is told of a marker; shares below 1 % are not."""
    marker = next(one for one in found.markers if one.name == name)
    return marker.probability if marker.segment == segment else dict(marker.alternatives).get(segment, 0.0)


@pytest.fixture(scope="module")
def worn():
    return standing(SET, 1)


@pytest.fixture(scope="module")
def found(worn):
    return inferred(worn)


@pytest.fixture(scope="module")
def walk():
    return walking(SET, 1)


@pytest.fixture(scope="module")
def boxed(walk):
    """A person who walks past a box that stood there in the static trial already."""
    static, moving = (one.beside(box_at(0.8, 1.2, 0.0)) for one in walk)
    return static, moving, inferred(static, moving)


def test_a_standing_person_is_found_without_names(worn, found):
    assert worn.share_right(found.markers) >= 0.95
    assert found.found.equipment.name == "the whole body"


@pytest.mark.parametrize("protocol", ["autolabel62", "qualisys_sports", "oxford_biomechzoo"])
def test_so_are_persons_with_other_markers(protocol):
    worn = standing(protocol, 2)
    assert worn.share_right(inferred(worn, leave_out=(protocol,)).markers) >= 0.95


def test_probabilities_are_shares_of_one(worn, found):
    for marker in found.markers:
        odds = [marker.probability, *(share for _, share in marker.alternatives)]
        assert all(0.0 <= share <= 1.0 for share in odds)
        assert sum(odds) <= 1.0 + 0.001 * len(odds), "they are rounded"
        assert sum(odds) > 0.85, "what is not told is below 1 % each, or of no body"
        assert odds == sorted(odds, reverse=True)


def test_turned_and_shifted_it_is_the_same(worn, found):
    again = inferred(worn.turned(2.5, (1.0, -4.0, 0.2)))
    assert [one.segment for one in again.markers] == [one.segment for one in found.markers]
    np.testing.assert_allclose(
        [one.probability for one in again.markers], [one.probability for one in found.markers], atol=0.1
    )


def test_a_mirror_image_is_a_person_with_right_and_left_exchanged(worn, found):
    """Without names nothing tells them apart."""
    image = worn.mirrored()
    again = inferred(image)
    assert image.share_right(again.markers) == worn.share_right(found.markers)


@pytest.mark.parametrize(
    ("protocol", "without", "least", "seed"),
    [
        ("autolabel62", (*ARMS, *HEAD, "torso"), 0.95, 1),  # pelvis and legs
        ("autolabel62", (*LEGS, *HEAD), 0.9, 2),  # trunk and arms, of a wheelchair user; lumbar markers hide
        ("hbm47", (*LEGS, *HEAD), 0.95, 1),
        ("autolabel62", LEGS, 0.9, 2),
        ("autolabel62", (*LEGS, *HEAD, "left_upper_arm", "left_forearm", "left_hand"), 0.8, 1),
        ("rehazenter52", (*LEGS, "right_upper_arm", "right_forearm", "right_hand"), 0.9, 2),
    ],
)
def test_parts_of_a_body_are_found(protocol, without, least, seed):
    worn = standing(protocol, seed, without)
    assert worn.share_right(inferred(worn, leave_out=(protocol,)).markers) >= least


def test_a_walk_beside_the_static_tells_every_marker(boxed):
    static, _, found = boxed
    on_body = [one for one in found.markers if static.segments[one.name]]
    right = [near(one.segment, static.segments[one.name]) for one in on_body]
    assert np.mean(right) >= 0.95
    assert found.rms_m < 0.02


def test_a_box_that_stands_beside_is_no_body(boxed):
    """Where a person walks, the box does not; where he only stands, it is too far away."""
    static, _, found = boxed
    box = [one for one in found.markers if not static.segments[one.name]]
    assert [one.segment for one in box] == [""] * len(BOX_M)
    alone = inferred(static)
    assert [one.segment for one in alone.markers if not static.segments[one.name]] == [""] * len(BOX_M)


def test_a_walk_alone_is_enough(walk):
    assert walk[1].share_right(inferred(None, walk[1]).markers) >= 0.9


def test_places_are_normally_distributed_in_space():
    offset, sd = np.array([0.01, -0.02, 0.03]), 0.025
    expected = multivariate_normal(np.zeros(3), sd**2).logpdf(offset)
    assert place_log_density(np.array(offset @ offset), np.array(sd**2)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "reading",
    [
        told("right_thigh"),
        told("right_thigh", "right_knee_lateral"),
        told("torso", "no landmark", 0.4),
        NameReading("", (NamedPlace("pelvis", "", 0.6), NamedPlace("torso", "c7", 0.4)), "marker", ""),
    ],
)
def test_a_name_only_moves_the_density_about(reading):
    """Σ w f = 1: in the mean over all places a name changes nothing; places it does not mean keep what is left."""
    factors = name_factors(PLACES, reading)
    assert PLACES.weight @ factors == pytest.approx(1.0, abs=1e-9)
    assert (factors >= OTHER_NAME - 1e-12).all()
    segments = np.array(PLACES.segments)
    meant = [place.segment for place in reading.places]
    assert factors[np.isin(segments, meant)].min() > factors[~np.isin(segments, meant)].max() - 1e-12


def test_no_name_tells_nothing():
    for reading in (None, NameReading("x", (), "unknown", "")):
        np.testing.assert_array_equal(name_factors(PLACES, reading), 1.0)


def test_a_landmark_is_likelier_than_the_rest_of_its_segment():
    factors = name_factors(PLACES, told("right_thigh", "right_knee_lateral"))
    at = np.array([name == "right_knee_lateral" for name in PLACES.landmarks])
    own = np.array([segment == "right_thigh" for segment in PLACES.segments])
    assert factors[at].min() > factors[own & ~at].max()


@pytest.mark.parametrize(
    ("name", "neighbour"), [("RKNE", "right_shank"), ("LELB", "left_forearm"), ("C7", "head")]
)
def test_names_change_probabilities_towards_what_they_tell(worn, found, name, neighbour):
    own = worn.segments[name]
    right = inferred(worn, readings={name: told(own)})
    wrong = inferred(worn, readings={name: told(neighbour)})
    assert probability_of(right, name, own) >= probability_of(found, name, own) - 0.01
    assert probability_of(wrong, name, neighbour) >= probability_of(found, name, neighbour) - 0.01
    assert probability_of(wrong, name, own) <= probability_of(right, name, own)


def test_markers_that_are_never_seen_are_left_out(worn):
    unseen = worn.moved(
        lambda points: np.where(np.arange(points.shape[1])[None, :, None] == 4, np.nan, points)
    )
    names = [one.name for one in inferred(unseen).markers]
    assert worn.markers.names[4] not in names
    assert len(names) == len(worn.markers.names) - 1


def test_too_few_points_are_refused(worn):
    few = worn.markers.select(worn.markers.names[:11])
    with pytest.raises(NotObservable, match="11 points"):
        infer_markers([few], [], {}, BODY)
