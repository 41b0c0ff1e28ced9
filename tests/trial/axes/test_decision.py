"""Wrong axes are put right where body and plates agree about them, else refused; right ones stay to the last bit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.io.axes import axes_matrix
from mbkf.io.records import AxesSource, Capture
from mbkf.io.turning import turned
from mbkf.model.protocol import load_protocol
from mbkf.trial.axes.decision import AxesFinding, Verdict, find_axes, right_axes
from mbkf.trial.axes.evidence import MarkerPlaces, marker_places
from mbkf.trial.axes.plates import pushed_away
from tests.captures import LEGS, made_capture, only

PROTOCOL = load_protocol("reference36")
SAME = np.eye(3)
MIRROR = np.diag([1.0, -1.0, 1.0])
ON_ITS_BACK = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Up becomes −x, forward becomes up."""


def places(capture: Capture) -> MarkerPlaces:
    return marker_places(capture.markers.names, PROTOCOL.match(capture.markers.names), PROTOCOL.body)


def misread(capture: Capture, turn: np.ndarray, source: AxesSource = AxesSource.DEFAULT) -> Capture:
    """A capture as a reader gives it that does not know of the turn."""
    return replace(turned(capture, turn, source), axes="x,y,z", up_axis="z")


def without_corners(capture: Capture) -> Capture:
    return replace(capture, plates=tuple(replace(plate, corners_m=None) for plate in capture.plates))


def found(capture: Capture) -> AxesFinding:
    return find_axes(capture, places(capture))


def moved_foot(capture: Capture, stretched_rad: float = 1.0) -> Capture:
    """The person with both feet stretched: their markers turned about the ankles."""
    segments = {m.name: m.segment for m in PROTOCOL.markers}
    positions = capture.markers.positions_m.copy()
    c, s = np.cos(stretched_rad), np.sin(stretched_rad)
    for side in ("right", "left"):
        words = (f"{side}_foot", f"{side}_toes")
        columns = [i for i, name in enumerate(capture.markers.names) if segments[name] in words]
        ankle = positions[:, columns].mean(axis=1, keepdims=True)
        turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        positions[:, columns] = (positions[:, columns] - ankle) @ turn.T + ankle
    return replace(capture, markers=replace(capture.markers, positions_m=positions))


signed_permutations = st.builds(
    lambda order, signs: np.eye(3)[list(order)] * np.array(signs)[:, None],
    st.permutations(range(3)),
    st.lists(st.sampled_from([-1.0, 1.0]), min_size=3, max_size=3),
)


@settings(max_examples=60, deadline=None)
@given(signed_permutations, st.sampled_from(["no plates", "corners", "no corners"]), st.booleans())
def test_any_signed_permutation_is_put_right_or_refused(turn, plates, legs_only):
    capture = made_capture(10)
    if legs_only:
        capture = replace(capture, markers=only(capture.markers, LEGS))
    if plates == "no plates":
        capture = replace(capture, plates=())
    if plates == "no corners":
        capture = without_corners(capture)
    read = misread(capture, turn)
    try:
        (result,) = right_axes([read], [places(read)])
    except InvalidInput as error:
        assert "--axes" in str(error) or "--up" in str(error)
        return
    whole = axes_matrix(result.axes) @ turn
    assert whole[2, 2] == 1.0
    assert np.linalg.det(whole) > 0.0
    np.testing.assert_allclose(result.markers.positions_m, capture.markers.positions_m @ whole.T, atol=1e-12)
    assert pushed_away(result.plates) == ""
    for plate, true in zip(result.plates, capture.plates, strict=True):
        np.testing.assert_allclose(plate.force_n, true.force_n @ whole.T, atol=1e-9)
        np.testing.assert_allclose(plate.centre_of_pressure_m, true.centre_of_pressure_m @ whole.T, atol=1e-9)


@pytest.mark.parametrize("source", AxesSource)
def test_right_axes_stay_to_the_last_bit(source):
    capture = made_capture(10, axes_source=source)
    assert right_axes([capture], [places(capture)]) == [capture]
    assert right_axes([capture], [places(capture)])[0] is capture


def test_a_mirrored_capture_is_told_in_one_line():
    read = replace(misread(made_capture(10, plates=()), MIRROR), axes="x,-z,y", up_axis="y")
    (result,) = right_axes([read], [places(read)])
    assert result.notes == (
        "markers mirrored: z flipped (right markers lay left of the left ones); --axes=x,-z,y keeps them",
    )
    assert (result.axes, result.up_axis, result.axes_source) == ("x,z,y", "y", AxesSource.BODY)


def test_given_axes_are_kept():
    read = misread(made_capture(10), -np.eye(3), AxesSource.GIVEN)
    assert found(read).verdict is Verdict.GIVEN
    assert right_axes([read], [places(read)])[0] is read


def test_a_given_up_is_kept_and_a_mirror_image_found_all_the_same():
    lying = found(misread(made_capture(10, plates=()), ON_ITS_BACK, AxesSource.UP_GIVEN))
    assert (lying.verdict, lying.turn.tolist()) == (Verdict.KEPT, np.eye(3).tolist())
    assert "as given" in lying.note
    assert (
        found(misread(made_capture(10, plates=()), MIRROR, AxesSource.UP_GIVEN)).verdict is Verdict.PUT_RIGHT
    )


def test_names_of_right_and_left_exchanged_are_not_a_mirror_image():
    """The corners of the plates show that the coordinates are right-handed."""
    capture = made_capture(10, axes_source=AxesSource.PLATES)
    sides = {"R": "L", "L": "R"}
    names = capture.markers.names
    paired = {n: sides[n[0]] + n[1:] for n in names if n[0] in sides and sides[n[0]] + n[1:] in names}
    assert len(paired) > 20
    swapped = replace(capture.markers, names=tuple(paired.get(n, n) for n in names))
    refused = found(replace(capture, markers=swapped))
    assert refused.verdict is Verdict.REFUSED
    assert "exchanged" in refused.note
    alone = replace(capture, markers=swapped, plates=(), axes_source=AxesSource.DEFAULT)
    assert found(alone).verdict is Verdict.PUT_RIGHT, "without plates nobody can tell"


def test_plates_that_push_elsewhere_than_the_body_stands_are_refused():
    """Markers upside down, forces upwards; then markers upright, forces along x."""
    capture = without_corners(made_capture(10))
    head_down = misread(replace(capture, plates=()), np.diag([1.0, -1.0, -1.0]))
    refused = found(replace(head_down, plates=capture.plates))
    assert refused.verdict is Verdict.REFUSED
    assert "the plates push along -z" in refused.note
    sideways = misread(capture, ON_ITS_BACK)
    refused = found(replace(capture, plates=sideways.plates))
    assert refused.verdict is Verdict.REFUSED
    assert "stands upright, but the plates push along -x" in refused.note
    without = find_axes(replace(capture, plates=sideways.plates), places(capture), with_plates=False)
    assert without.verdict is Verdict.RIGHT, "plates are not used to scale"


def test_a_person_who_lies_is_not_put_on_the_feet():
    lying = misread(moved_foot(made_capture(10, plates=())), ON_ITS_BACK)
    unclear = found(lying)
    assert unclear.verdict is Verdict.UNCLEAR
    with pytest.raises(InvalidInput, match="--up"):
        right_axes([lying], [places(lying)])
    standing = made_capture(10, plates=(), axes_source=AxesSource.DEFAULT)
    both = right_axes([standing, lying], [places(standing), places(lying)])
    assert both[1] is lying, "the static trial tells which axis points up"
    stated = found(replace(lying, axes_source=AxesSource.PLATES))
    assert stated.verdict is Verdict.KEPT
    assert "as the file says" in stated.note


def test_where_feet_are_not_seen_the_floor_decides():
    """Along the body's height the lowest markers lie as feet do; as read, they are under the floor, or rise."""
    lying = misread(made_capture(10, plates=()), ON_ITS_BACK)
    segments = {m.name: m.segment for m in PROTOCOL.markers}
    footless = tuple(
        name for name in lying.markers.names if segments[name].split("_")[-1] not in ("foot", "toes")
    )
    assert len(footless) < len(lying.markers.names)
    markers = lying.markers.select(footless)

    def moved(back_m: float, sole_m: float, rise_m: float = 0.0, source=AxesSource.DEFAULT) -> Verdict:
        head, back = float(markers.positions_m[:, :, 0].max()), float(markers.positions_m[:, :, 2].min())
        positions = markers.positions_m + np.array([-sole_m - head, 0.0, back_m - back])
        positions[:, :, 2] += np.linspace(0.0, rise_m, len(positions))[:, None]
        return found(
            replace(lying, markers=replace(markers, positions_m=positions), axes_source=source)
        ).verdict

    assert moved(-0.1, 0.1) is moved(0.05, 0.1, 0.5) is Verdict.PUT_RIGHT
    assert moved(0.05, 0.1) is moved(-0.1, 0.6) is moved(0.05, 0.1, 0.2) is Verdict.UNCLEAR
    assert moved(-0.1, 0.1, source=AxesSource.SCREEN) is Verdict.PUT_RIGHT
    assert moved(0.05, 0.1, source=AxesSource.SCREEN) is Verdict.KEPT
    assert moved(-0.1, 0.1, source=AxesSource.PLATES) is Verdict.KEPT


def rising(turn: np.ndarray = SAME, stretched_rad: float = 1.0) -> Capture:
    """A person who lies in sixteen frames of twenty, then stands, in axes misread by a turn."""
    standing = made_capture(20, plates=())
    positions = moved_foot(standing, stretched_rad).markers.positions_m @ ON_ITS_BACK.T
    positions[16:] = standing.markers.positions_m[16:]
    return misread(replace(standing, markers=replace(standing.markers, positions_m=positions)), turn)


def test_a_standing_trial_without_forefoot_markers_stands():
    """Markers at the heels do not show the direction of a foot; those of the forefoot contradict a wrong statement."""
    capture = misread(made_capture(10, plates=()), ON_ITS_BACK)
    toeless = tuple(s.name for s in PROTOCOL.body.segments if not s.name.endswith(("foot", "toes")))
    some = only(capture.markers, toeless)
    few = replace(
        capture, markers=replace(some, positions_m=some.positions_m + 2.0)
    )  # the floor is not at the origin
    assert found(few).verdict is Verdict.UNCLEAR
    standing = find_axes(few, places(few), standing=True)
    assert standing.verdict is Verdict.PUT_RIGHT
    upright = standing.turn @ ON_ITS_BACK
    assert (upright[2].tolist(), np.linalg.det(upright)) == ([0.0, 0.0, 1.0], pytest.approx(1.0))
    lying = misread(moved_foot(made_capture(10, plates=())), ON_ITS_BACK)
    assert find_axes(lying, places(lying), standing=True).verdict is Verdict.UNCLEAR
    (put_right,) = right_axes([few], [places(few)], standing=1)
    assert put_right.axes != few.axes


def test_fingers_show_no_size():
    """A hundredth of a person's size is refused, except where only segments of uncertain size carry markers."""
    capture = made_capture(10, plates=())
    small = replace(capture, markers=replace(capture.markers, positions_m=0.01 * capture.markers.positions_m))
    assert found(small).verdict is Verdict.REFUSED
    where = places(small)
    hands = replace(where, segments=tuple("right_hand" for _ in where.segments))
    assert find_axes(small, hands).verdict is not Verdict.REFUSED


def test_a_person_who_gets_up_is_left_as_read():
    kept = found(rising())
    assert kept.verdict is Verdict.KEPT
    assert "stands on its feet along z only" in kept.note
    np.testing.assert_array_equal(kept.turn, np.eye(3))


def test_a_person_who_gets_up_along_the_floor_is_refused():
    """Misread so that lying looks upright: where the feet stand, the body is along another axis."""
    unclear = found(rising(ON_ITS_BACK.T))
    assert unclear.verdict is Verdict.UNCLEAR
    assert "20 % of frames" in unclear.note
    assert found(rising(stretched_rad=0.0)).verdict is Verdict.UNCLEAR, "lying with the feet at right angles"


def test_a_person_known_to_stand_is_not_laid_down_by_another_capture():
    """The handedness that one trial lacks is taken from the other, the up that it has is not."""
    standing = made_capture(10, plates=(), axes_source=AxesSource.DEFAULT)
    flat = replace(places(standing), neutral_m=places(standing).neutral_m * [0.0, 1.0, 1.0])
    for other, axes in ((misread(standing, MIRROR), "x,-y,z"), (misread(standing, ON_ITS_BACK), "x,y,z")):
        both = right_axes([other, standing], [places(other), flat])
        assert both[1].axes == axes


@pytest.mark.parametrize(("factor", "proposed"), [(10.0, "mm"), (0.1, None), (100.0, None)])
def test_bodies_of_no_persons_size_are_refused(factor, proposed):
    capture = made_capture(10, plates=(), length_unit="cm")
    grown = replace(capture.markers, positions_m=factor * capture.markers.positions_m)
    refused = found(replace(capture, markers=grown))
    assert refused.verdict is Verdict.REFUSED
    assert "outside 0.65 to 2.6 m" in refused.note
    assert "--unit" in refused.note
    if proposed:
        assert f"--unit {proposed}" in refused.note


def test_markers_with_names_of_others_tell_nothing():
    capture = misread(made_capture(10, plates=()), MIRROR)
    wrong = replace(capture.markers, positions_m=capture.markers.positions_m[:, ::-1])
    assert found(replace(capture, markers=wrong)).verdict is Verdict.UNKNOWN


def test_a_capture_that_does_not_tell_takes_the_axes_of_another():
    read = misread(made_capture(10, plates=()), MIRROR)
    few = replace(read, markers=read.markers.select(read.markers.names[:4]))
    assert found(few).verdict is Verdict.UNKNOWN
    both = right_axes([read, few], [places(read), places(few)])
    assert [one.axes for one in both] == ["x,-y,z", "x,-y,z"]
    right = made_capture(10, plates=(), axes_source=AxesSource.DEFAULT)
    torn = right_axes([read, right, few], [places(one) for one in (read, right, few)])
    assert torn[2] is few, "the others do not agree"
    (alone,) = right_axes([few], [places(few)])
    assert alone is few


def test_markers_without_depth_do_not_tell_handedness():
    capture = made_capture(10, plates=())
    names = capture.markers.names
    columns = places(capture)
    flat = replace(columns, neutral_m=columns.neutral_m * [0.0, 1.0, 1.0])
    kept = find_axes(capture, flat)
    assert len(names) == len(flat.columns)
    assert kept.verdict is Verdict.KEPT
    assert "do not show whether they are mirrored" in kept.note
