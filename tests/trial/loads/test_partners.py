"""Another person near a segment: a possible contact, and a cause of an unexplained load."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.loads.partners import LIMB_M, near_segments, others_of, with_contacts
from tests.io.reconstructions import made_up
from tests.motions import reference_model

RATE_HZ, FRAMES = 100.0, 60
MODEL = reference_model()


def beside(segment, child, apart_m):
    """A marker that far from the middle of a segment's line, from frame 20 to frame 39, and away else."""
    _, origins = MODEL.placements(MODEL.neutral())
    hip, knee = (origins[MODEL.joint(name).joint_id] for name in (segment, child))
    across = np.cross(knee - hip, [1.0, 0.0, 0.0])
    places = np.full((FRAMES, 1, 3), 5.0)
    places[20:40, 0] = 0.5 * (hip + knee) + apart_m * across / np.linalg.norm(across)
    return MarkerTrajectories(("Ben:WRA",), places, RATE_HZ)


def near(others):
    own = MarkerTrajectories(("K",), np.full((FRAMES, 1, 3), np.nan), RATE_HZ)
    subject = SimpleNamespace(markers=(SimpleNamespace(name="K", segment="right_shank"),))
    return near_segments(MODEL, np.tile(MODEL.neutral(), (FRAMES, 1)), own, subject, others)


def test_a_hand_beside_the_middle_of_a_thigh_is_near_it():
    (found,) = near(beside("right_thigh", "right_shank", 0.12))
    assert (found.part, found.from_s, found.to_s) == ("right thigh", 0.2, 0.39)
    assert found.nearest_m == pytest.approx(0.12 - LIMB_M, abs=1e-9)
    assert near(beside("right_thigh", "right_shank", 0.17)) == []


def test_a_marker_of_the_person_counts_as_its_segment():
    others = beside("right_thigh", "right_shank", 0.5)
    own = MarkerTrajectories(("K",), others.positions_m + np.array([0.03, 0.0, 0.0]), RATE_HZ)
    subject = SimpleNamespace(markers=(SimpleNamespace(name="K", segment="right_shank"),))
    found = near_segments(MODEL, np.full((FRAMES, MODEL.nq), np.nan), own, subject, others)
    assert [one.part for one in found] == ["right shank"] and found[0].nearest_m == pytest.approx(0.03)


def test_a_load_meanwhile_names_the_other_person():
    loads = tuple(
        UnexplainedLoad(begin, begin + 0.1, (0.0, 0.0, 80.0), 5.0, 0.1, cause, "a seat?")
        for begin, cause in ((0.25, ""), (0.25, "clock"), (0.5, ""))
    )
    others = beside("right_thigh", "right_shank", 0.12)
    result = made_up(frames=FRAMES, unexplained=loads, q=np.tile(MODEL.neutral(), (FRAMES, 1)))
    none = MarkerTrajectories((), np.zeros((FRAMES, 0, 3)), RATE_HZ)
    found = with_contacts(result, MODEL, result.subject, none, others)
    hints = [one.hint for one in found.unexplained]
    assert hints[0].startswith(
        "another person is near: 70 mm from the right thigh from 0.20 to 0.39 s, the likely cause"
    )
    assert hints[1:] == ["a seat?", "a seat?"]
    assert "right thigh" in found.warnings[-1] and "possible contact" in found.warnings[-1]
    assert with_contacts(result, MODEL, result.subject, none, None) is result


def test_others_are_those_left_out_by_a_choice_or_somebody_else_in_view():
    places = np.zeros((4, 9, 3))
    places[:, 2:, 1] = 3.0
    capture = Capture("a", MarkerTrajectories(("A", "B", *(f"Q{k}" for k in range(7))), places, RATE_HZ))
    found = others_of(capture, ("A", "B"))
    assert found is not None and found.names == capture.markers.names[2:]
    assert others_of(capture, capture.markers.names) is None
    chosen = Capture("a", found, others=capture.markers)
    assert others_of(chosen, ()) is capture.markers
