"""Evidence of a result: parts that nothing shows, frames of known loads, spreads and doubts."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import LOAD_PARTS
from mbkf.trial.verdict.evidence import evidence_of
from tests.recordings import broken_walk, leaning_walk, walk

NO_LEFT_ARM = tuple(f"left_{one}_{axis}" for one in ("upper_arm", "forearm", "hand") for axis in "xyz")


def test_a_whole_trial_speaks_for_itself():
    found = evidence_of(walk())
    assert found.tracked == found.explained == 1.0
    assert found.unshown == found.beyond == found.contacts == ()
    assert found.trunk_shown and not found.unshown_segments
    assert {one.part for one in found.fits} >= {"pelvis", "trunk", "right_leg", "left_leg"}
    assert found.spread_deg["right_leg"] == pytest.approx(np.rad2deg(0.02))


def test_a_limb_without_markers_is_not_shown():
    r = walk()
    held = tuple(name for name in NO_LEFT_ARM if name in r.dof_names)
    found = evidence_of(replace(r, unobserved_dofs=held))
    assert found.unshown == ("left_arm",) and "left_arm" not in found.spread_deg
    foot = tuple(name for name in r.dof_names if name.startswith("right_foot"))
    assert evidence_of(replace(r, unobserved_dofs=foot)).unshown_segments == {"right_leg": ("right_foot",)}


def test_a_pelvis_without_markers_is_not_shown():
    r = walk()
    own = {marker.name: marker.segment for marker in r.subject.markers}
    there = np.array([own[name] == "pelvis" for name in r.marker_names])
    gone = np.where(there[None, :, None], np.nan, r.measured_m)
    assert evidence_of(replace(r, measured_m=gone)).unshown == ("pelvis",)


def test_loads_that_are_never_known_are_not_shown():
    r = walk()
    assert evidence_of(replace(r, valid=np.zeros(r.frames, bool))).unshown == LOAD_PARTS


def test_an_unexplained_force_spoils_its_share_of_the_frames():
    r = walk()
    last_s = float(r.times_s[r.frames // 2 - 1])
    pull = UnexplainedLoad(float(r.times_s[0]), last_s, (0.0, 0.0, 200.0), 8.0, 0.3)
    valid = r.times_s > last_s + 1e-9
    found = evidence_of(replace(r, unexplained=(pull,), valid=valid))
    assert found.unexplained_share == pytest.approx(0.5, abs=0.01)


def test_loads_besides_the_feet_and_lost_frames_are_evidence():
    assert evidence_of(broken_walk()).tracked < 1.0
    assert {one.part for one in evidence_of(leaning_walk()).contacts} == {"right_hand", "pelvis"}


def test_doubts_of_the_subject_s_file_are_evidence():
    r = walk()
    doubtful = replace(r.subject, report={"doubts": ["the fit did not converge"]})
    assert evidence_of(replace(r, subject=doubtful)).doubts == ("the fit did not converge",)


def test_a_mended_limb_is_in_doubt_until_then_and_not_at_all_once_smoothed():
    r = walk()
    half_s = float(r.times_s[r.frames // 2 - 1])
    doubt = LimbDoubt("left_thigh", "turned over", float(r.times_s[0]), half_s, mended=True)
    ((_, share),) = evidence_of(replace(r, limb_doubts=(doubt,))).doubtful_limbs
    assert share == pytest.approx(0.5, abs=0.01)
    assert evidence_of(replace(r, limb_doubts=(doubt,), smoothed=True)).doubtful_limbs == ()
    assert (
        len(
            evidence_of(replace(r, limb_doubts=(replace(doubt, mended=False),), smoothed=True)).doubtful_limbs
        )
        == 1
    )
