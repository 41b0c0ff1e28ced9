"""The thesis's ranks of torques and reactions, and those of the dynamic filter."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.model.protocol import load_protocol
from mbkf.trial.filter_observability import (
    COMPLETE,
    CUT,
    PLANT,
    SIMPLIFIED,
    WITH_PRIORS,
    check_filter,
    plate_feet,
)
from mbkf.trial.preparation.presets import with_preset, with_set
from mbkf.trial.preparation.settings import ReconstructSettings

PROTOCOL = load_protocol("reference36")
DEFAULT = ReconstructSettings()
LITERAL = with_preset(DEFAULT, "FDMC-literal")
TORQUE, DYNAMIC = replace(DEFAULT, filter="torque"), replace(DEFAULT, filter="dynamic")


def ranks(check):
    return {name: {one.rank for one in points} for name, points in check.variants.items()}


@pytest.fixture(scope="module")
def literal():
    return check_filter(PROTOCOL, LITERAL)


@pytest.fixture(scope="module")
def unread():
    """Without plates."""
    return check_filter(PROTOCOL, LITERAL, without=["both"])


def test_markers_and_plates_determine_torques_by_complete_and_simplified_f(literal):
    """Thesis 4.1.4.2: all 166 states; ∂z̈/∂T_e is the block that cannot be left out."""
    assert len(literal.state) == 166
    found = ranks(literal)
    assert found[COMPLETE] == found[SIMPLIFIED] == {166}
    assert found[CUT] == {116}
    assert literal.complete and literal.own == SIMPLIFIED


def test_without_plates_reactions_and_torques_are_known_by_their_sum(unread):
    found = ranks(unread)
    assert found[COMPLETE] == found[SIMPLIFIED] == found[WITH_PRIORS] == {154}
    assert found[CUT] == {104}
    parts = {one.part for one in unread.unobserved}
    assert parts == {"pelvis residual", "torque", "right foot", "left foot"}
    turned = {one.name[:-2] for one in unread.unobserved if one.part == "torque"}
    assert turned == {
        f"{side}_{segment}" for side in ("right", "left") for segment in ("thigh", "shank", "foot")
    }


def test_what_counts_and_what_does_not_lie_far_apart(unread):
    for points in unread.variants.values():
        for one in points:
            least, silent = one.gap
            assert least > 0.05
            assert silent < 1e-8


def test_each_plate_counts_for_six(literal):
    one_foot = check_filter(PROTOCOL, TORQUE, without=["left"])
    assert ranks(one_foot)[COMPLETE] == {160}
    assert ranks(one_foot)[WITH_PRIORS] == {166}, "the pelvis residual near zero gives the other foot's"
    assert {one.part for one in one_foot.unobserved} == {"left foot"}


def test_torques_of_an_inertial_state_are_named_as_such():
    parts = {one.part for one in check_filter(PROTOCOL, TORQUE).state}
    assert "accelerating torque" in parts
    assert "torque" not in parts


def test_wrenches_that_are_known_inputs_leave_the_state():
    given = check_filter(PROTOCOL, with_set(LITERAL, ["plates=inputs"]), without=["left"])
    assert given.loads_given
    assert len(given.state) == 154
    assert ranks(given)[SIMPLIFIED] == {154}


@pytest.mark.parametrize(("without", "rank"), [([], 174), (["right"], 168), (["1", "2"], 162)])
def test_the_dynamic_filter_knows_accelerations_from_markers_and_loads_from_plates_or_newtons_law(
    without, rank
):
    check = check_filter(PROTOCOL, DYNAMIC, without=without)
    assert len(check.state) == 174
    assert ranks(check)[PLANT] == {rank}


def test_lost_markers_take_positions_velocities_and_torques():
    check = check_filter(PROTOCOL, LITERAL, lost=["RHA2", "RHA5"])
    assert check.lost == ("RHA2", "RHA5")
    assert len(check.markers) == 34
    assert max(ranks(check)[SIMPLIFIED]) < 166
    assert {"right_hand"} <= {one.name[:-2] for one in check.unobserved}
    assert {one.part for one in check.unobserved} >= {"position", "velocity", "torque"}


def test_a_direction_that_no_reading_shows_accelerates_nothing(unread):
    """Independent of F: forces along it are added to the body, and its acceleration is the same."""
    from mbkf.model.human import HumanModel
    from mbkf.model.human_dynamics import HumanDynamics

    s = LITERAL.torque
    body = HumanDynamics(HumanModel.scaled(body=PROTOCOL.body), None, s.wrench_frame, s.force_state)
    sizes, still = np.array([one.size for one in unread.state]), np.zeros(body.nv)
    standing, q = unread.found[0], body.model.neutral()
    for direction in standing.directions[standing.rank :]:
        forces = (sizes * direction)[2 * body.nv :]
        moved = body.acceleration(q, still, forces) - body.acceleration(q, still, np.zeros(body.nu))
        assert np.abs(forces).max() > 1.0
        np.testing.assert_allclose(moved, 0.0, atol=1e-8)


def test_plates_are_named_by_foot_or_number():
    assert plate_feet([]) == ()
    assert plate_feet(["2"]) == ("left",)
    assert plate_feet(["left", "1"]) == plate_feet(["both"]) == ("right", "left")
    with pytest.raises(UnknownName, match="--without-plate: unknown plate 'rigth'; did you mean right"):
        plate_feet(["rigth"])


def test_wrong_requests_are_refused():
    with pytest.raises(InvalidInput, match="kinematic filter holds no torques"):
        check_filter(PROTOCOL, replace(DEFAULT, filter="kinematic"))
    with pytest.raises(UnknownName, match="did you mean RHEE"):
        check_filter(PROTOCOL, TORQUE, lost=["RHEEL"])
    with pytest.raises(NotObservable, match="no marker left"):
        check_filter(PROTOCOL, TORQUE, lost=[one.name for one in PROTOCOL.markers])
