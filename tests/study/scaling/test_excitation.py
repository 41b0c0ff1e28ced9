"""Excursions of the joints are those that were made, whichever way the person faces; strange markers are refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import NotObservable
from mbkf.io.session import TrialKind
from mbkf.study.scaling.excitation import FRAMES, StandingBody
from tests.bending import arms_lifted, posed, squat, stander, standing, walk


@pytest.fixture(scope="module")
def body():
    return StandingBody(stander(), standing().markers)


@pytest.mark.parametrize("hip_deg, knee_deg", [(105.0, 100.0), (50.0, 70.0)])
def test_flexion_is_found(body, hip_deg, knee_deg):
    found = body.excitation(squat(hip_deg, knee_deg).markers)
    assert (found.hips_deg, found.knees_deg) == pytest.approx((hip_deg, knee_deg), abs=3.0)
    assert max(found.upper_deg.values()) < 5.0 and found.coverage == 1.0


def test_the_leg_that_bends_less_counts(body):
    found = body.excitation(posed({"right_thigh": 100.0, "right_shank": 110.0}).markers)
    assert max(found.hips_deg, found.knees_deg, found.swing_deg) < 5.0


def test_a_walk_and_lifted_arms(body):
    found = body.excitation(walk().markers)
    assert found.kind == TrialKind.WALK and found.swing_deg == pytest.approx(60.0, abs=5.0)
    lifted = body.excitation(arms_lifted().markers).upper_deg
    assert lifted["right_upper_arm"] == pytest.approx(145.0, abs=6.0) and lifted["torso"] < 5.0
    assert "pelvis" not in lifted and "right_thigh" not in lifted and "head" not in lifted


def test_heading_and_place_do_not_matter(body):
    markers = squat().markers
    turn = Rotation.from_euler("z", 130.0, degrees=True).as_matrix()
    moved = replace(markers, positions_m=markers.positions_m @ turn.T + [3.0, 1.0, 0.0])
    one, other = (body.excitation(each) for each in (markers, moved))
    assert (one.hips_deg, one.knees_deg) == pytest.approx((other.hips_deg, other.knees_deg), abs=0.1)


def test_frames_with_gaps_are_passed_over(body):
    markers = squat().markers
    positions = markers.positions_m.copy()
    positions[::2, :30] = np.nan
    found = body.excitation(replace(markers, positions_m=positions))
    assert found.coverage == 1.0 and found.hips_deg > 100.0 and len(positions[1::2]) < FRAMES


def test_strange_markers_are_refused(body):
    markers = squat().markers
    with pytest.raises(NotObservable, match="another person"):
        body.excitation(squat(factor=1.1).markers)
    arm = [
        k
        for k, name in enumerate(markers.names)
        if name[1:] in {"ELB", "WRA", "WRB", "FIN", "HEE", "TOE", "ANK"}
    ]
    exchanged = markers.positions_m.copy()
    exchanged[:, arm] = exchanged[:, arm[::-1]]
    with pytest.raises(NotObservable, match=r"distances|exchanged names"):
        body.excitation(replace(markers, positions_m=exchanged))
    with pytest.raises(NotObservable):
        body.excitation(replace(markers, positions_m=np.full_like(exchanged, np.nan)))
