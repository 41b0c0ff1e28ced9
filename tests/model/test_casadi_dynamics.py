"""A person's CasADi functions: Pinocchio's numbers, names of inputs and rows, derivatives."""

import casadi as ca
import numpy as np
import pytest

import mbkf
from benchmarks.packages.casadi_agreement import agreement
from mbkf.errors import UnknownName
from mbkf.io.subject import Subject
from tests.motions import assert_near, moderate_pose, random_model, subject_of

RNG = np.random.default_rng(17)
MODEL = random_model(RNG)
PERSON = subject_of(MODEL)


@pytest.fixture(scope="module")
def dynamics():
    return mbkf.casadi_dynamics(PERSON)


def test_functions_give_the_numbers_of_pinocchio():
    assert max(agreement(PERSON, 10, np.random.default_rng(23)).values()) < 1e-12


def test_inputs_outputs_and_rows_have_names(dynamics):
    body = dynamics.body
    motion = ["q", "v"]
    assert dynamics.inverse_dynamics.name_in() == [*motion, "a", "foot_wrench"]
    assert dynamics.forward_dynamics.name_in() == [*motion, "tau", "foot_wrench"]
    assert dynamics.foot_jacobians.name_out() == ["right", "left"]
    assert dynamics.markers.name_out() == ["position_m", "velocity_m_s"]
    assert dynamics.dofs[body.joint("right_shank").v.start + 1] == "right_shank_y"
    assert dynamics.marker_names == tuple(marker.name for marker in PERSON.markers)
    assert dynamics.segment_names[0] == body.roles.root
    assert dynamics.sole_names[3] == "left_foot_heel"


def test_functions_are_called_by_names(dynamics):
    q, v = moderate_pose(MODEL, RNG), RNG.normal(size=MODEL.nv)
    found = dynamics.segments(q=q, v=v)["position_m"].full()
    assert_near(found[0], q[:3], 1e-15)


def test_a_body_without_markers_has_the_other_functions():
    dynamics = mbkf.casadi_dynamics(MODEL)
    assert dynamics.markers.size_out(0) == (0, 3)
    assert dynamics.segments.size_out(0) == (len(MODEL.joints), 3)


def test_derivatives_of_torques_by_a_step_are_those_of_finite_differences(dynamics):
    """Through the manifold, as an optimiser takes them, at a step of zero."""
    q, v, a = moderate_pose(MODEL, RNG), *RNG.normal(size=(2, MODEL.nv))
    step, wrench = ca.SX.sym("step", MODEL.nv), 100.0 * RNG.normal(size=(2, 6))
    tau = dynamics.inverse_dynamics(dynamics.integrate(q, step), v, a, wrench)
    values = ca.Function("tau", [step], [tau])
    along = RNG.normal(size=MODEL.nv)
    slope = ca.Function("slope", [step], [ca.jtimes(tau, step, ca.SX(along))])(np.zeros(MODEL.nv))
    h = 1e-5
    differences = (values(h * along) - values(-h * along)) / (2 * h)
    assert_near(slope.full(), differences.full(), 1e-5 * np.abs(slope.full()).max())


def test_an_unknown_body_is_named():
    with pytest.raises(UnknownName, match="human17"):
        mbkf.casadi_dynamics(Subject("human17", 70.0, {}, (), ""))
