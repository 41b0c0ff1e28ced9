"""Every derivative the package states is the numeric one along the manifold, and none escapes: they are found here.

Looked for are public fields, methods and functions of the rooms below whose name or docstring speaks of a derivative.
Each needs a case, which compares it with finite differences, or a line in :data:`ELSEWHERE`. Blocks and plants, those
of tests/blocks and tests/plants among them, have their cases by themselves (:mod:`tests.derivatives_of_blocks`,
:mod:`tests.derivatives_of_plants`).
"""

import dataclasses
import importlib
import inspect
import pkgutil
import re
import types
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest

from tests import (
    derivatives_of_blocks,
    derivatives_of_bodies,
    derivatives_of_filters,
    derivatives_of_inertial,
    derivatives_of_pendulum,
    derivatives_of_plants,
)
from tests.derivatives import CASES

ROOMS = ("model", "sensors", "filters", "numerics", "scaling")

NAMED = re.compile(
    r"(^|_)(jacobian|by|derivatives?|transition|phi|rows|sensitivity|linearise|slope|retraction|transport"
    r"|gradient|gain)(_|$)"
)
SAID = re.compile(r"(?i)derivative|jacobian|sensitivit")

PLAIN = {"bool", "int", "float", "str"}
"""Kinds of fields that hold no derivative whatever they are called."""

TESTS = Path(__file__).parent
ELSEWHERE = {
    "model.forced_body.ForcedBody.linearise": "model/test_forced_body.py",
    "model.forced_body.ForcedBody.retraction": "model/test_human_dynamics.py",
    "model.forced_body.ForcedBody.transport": "model/test_human_dynamics.py",
    "model.osim_kinematics.OsimKinematics.expanded": "model/test_osim_kinematics.py",
    "model.osim_kinematics.OsimPoses.points": "model/test_osim_kinematics.py",
    "sensors.gating.gated": "sensors/test_gating.py",
    "sensors.given_plates.GivenPlates.linearise": "sensors/test_given_plates.py",
    "filters.plant.Plant.step_transition": "filters/test_plant.py step_transition",
    "filters.dynamic.plant.SingerPlant.step_transition": "filters/test_plant.py step_transition",
    "filters.kinematic.plant.WhiteAccelerationPlant.step_transition": "filters/test_plant.py step_transition",
    "filters.torque.plant.TorquePlant.step_transition": "filters/test_plant.py step_transition",
    "filters.state_variances.state_variances": "filters/test_state_variances.py",
    "filters.spread.SpreadReader.rise_jacobian": "filters/test_spread.py rise",
    "filters.filter.Filter.prepared_by": "filters/test_filter.py",
    "numerics.discretisation.Discrete.phi": "numerics/test_discretisation.py",
    "numerics.kalman.information": "numerics/test_kalman.py",
    "numerics.kalman.informed_whole": "numerics/test_kalman.py",
    "numerics.information_update.informed_with_rows": "numerics/test_kalman.py",
    "numerics.levenberg_marquardt.ArrowEquations.corner_gradient": "numerics/test_levenberg_marquardt.py",
    "numerics.levenberg_marquardt.ArrowEquations.frame_gradient": "numerics/test_levenberg_marquardt.py",
    "numerics.elimination.Eliminated.gradient": "numerics/test_elimination.py eliminate",
    "numerics.elimination.RowBlock.rows": "numerics/test_elimination.py row_blocks",
    "sensors.subject_sensor.FlexedMarkerSensor.reading": "sensors/test_subject_sensor.py",
    "sensors.root_residual.DecayingLoad.linearise": "sensors/test_root_residual.py",
    "numerics.windows.second_derivative": "numerics/test_windows.py",
    "numerics.windows.slopes": "numerics/test_windows.py",
    "numerics.later_frames.LinearStep.transition": "numerics/test_later_frames.py",
    "numerics.smoothing.BackwardPass.through_frame": "numerics/test_smoothing.py through_frame",
    "numerics.transition.DenseTransition.phi": "numerics/test_transition.py",
    "numerics.rotations.exponential_and_left_jacobian": "numerics/test_rotations.py",
    "numerics.rotations.travel_by_turn": "numerics/test_rotations.py",
    "filters.record.Track.nis_by_kind": "trial/results/test_innovations.py nis_by_kind",
    "filters.record.Track.nis_readings_by_kind": "trial/results/test_innovations.py nis_readings_by_kind",
    "model.inertial_regressor.InertialRegressor.own": "model/test_inertial_regressor.py",
    "scaling.problem.ScalingProblem.places_by_factors": "scaling/test_covariance.py places_by_unknowns",
    "model.joint_centres.centre_levers": "model/test_joint_centres.py",
    "sensors.scaled_markers.ScaledMarkers.by_centres": "scaling/test_problem.py by_centres",
    "scaling.usual_posture.UsualPosture.equations": "scaling/test_usual_posture.py",
    "sensors.flexed_skin.FlexedSkin.add_by_poses": "sensors/test_flexed_skin.py",
    "scaling.problem.ScalingProblem.places_by_unknowns": "scaling/test_covariance.py",
    "sensors.gating.ObservedDofs.carried_by": "sensors/test_gating.py",
    "scaling.shoulders.TrialShoulders.by_displacements": "scaling/test_shoulders.py",
    "scaling.problem.ScalingProblem.linearise": "scaling/test_problem.py",
    "scaling.problem.ScalingProblem.shown": "scaling/test_problem.py",
    "model.scale_derivatives.OriginLevers.summed": "model/test_scale_derivatives.py",
    "scaling.standing.UprightPosture.linearised": "scaling/test_standing.py",
    "sensors.block.Rows.jacobian": "block_contract.py jacobian",
    "sensors.pose_fit.segment_by_segment": "sensors/test_pose_fit.py",
    "sensors.posture.prior_information": "sensors/test_posture.py posture_information",
    "sensors.marker_sensor.MarkerSensor.reading_of": "sensors/test_scaled_markers.py reading",
    "sensors.scaled_markers.ScaledMarkers.reading": "sensors/test_scaled_markers.py",
    "sensors.scaled_markers.ScaledReading.by_factors": "sensors/test_scaled_markers.py",
    "filters.dynamic.level_rows.LevelRows.at": "filters/dynamic/test_level_rows.py",
    "filters.section_errors.SectionErrors.at": "filters/test_section_errors.py",
    "model.motion_frames.motion_frames": "model/test_motion_frames.py",
    "model.newton_euler.NewtonEuler.compiled_loads": "model/test_trunk_sections.py",
    "model.trunk_sections.SectionState.by_root": "model/test_trunk_sections.py",
    "model.trunk_sections.SectionState.by_state": "model/test_trunk_sections.py",
    "model.trunk_sections.TrunkSections.by_root": "model/test_trunk_sections.py",
    "model.trunk_sections.TrunkSections.state": "model/test_trunk_sections.py",
    "scaling.records.ShownMarkers.by_factors": "scaling/test_problem.py test_gradient_by_poses_factors_and_offsets",
    "scaling.records.ShownMarkers.by_pose": "scaling/test_problem.py test_gradient_by_poses_factors_and_offsets",
    "model.casadi_dynamics.casadi_dynamics": "model/test_casadi_dynamics.py",
    "model.symbolic.recursions.world_jacobian": "model/symbolic/test_recursions.py",
    "sensors.pose_fit.joint_by_joint": "sensors/test_pose_fit.py",
    "model.forced_body.ForcedBody.force_response": "model/test_forced_body.py",
    "model.compiled_forces.CompiledForces.given": "model/test_compiled_forces.py joint_forces",
    "model.compiled_forces.CompiledForces.pull": "model/test_compiled_forces.py force_rows",
    "model.compiled_forces.CompiledForces.inertia_slope": "model/test_compiled_forces.py linearise",
    "model.compiled_forces.Given.by_q": "model/test_compiled_forces.py",
    "model.compiled_forces.Given.by_v": "model/test_compiled_forces.py",
    "model.compiled_forces.Given.by_state": "model/test_compiled_forces.py",
    "model.compiled_forces.Wrenches.by_q": "model/test_compiled_forces.py",
    "model.compiled_forces.Wrenches.by_state": "model/test_compiled_forces.py",
    "numerics.discretisation.Discrete.transition": "numerics/test_discretisation.py",
    "numerics.forced_error.ForcedRates.by_q": "numerics/test_forced_error.py",
    "numerics.forced_error.ForcedRates.by_v": "numerics/test_forced_error.py by_q",
    "numerics.forced_error.ForcedRates.by_u": "numerics/test_forced_error.py matrix",
    "numerics.forced_error.ForcedStep.transition": "numerics/test_forced_error.py",
    "numerics.forced_error.MotionStep.transition": "numerics/test_forced_error.py transition",
    "numerics.forced_error.LightStep.by_u": "numerics/test_forced_error.py LightStep",
    "numerics.forced_error.LightStep.transition": "numerics/test_forced_error.py",
    "numerics.information_update.positive_informed": "numerics/test_kalman.py",
}
"""What holds no derivative of its own or is algebra: the test file that checks each, and the name it has
there where that is another."""


def modules():
    for room in ROOMS:
        package = importlib.import_module(f"mbkf.{room}")
        for found in pkgutil.walk_packages(package.__path__, f"mbkf.{room}."):
            yield importlib.import_module(found.name)


def derivatives_in(module):
    """Dotted names, below ``mbkf``, of everything in a module that speaks of a derivative."""
    home = module.__name__.removeprefix("mbkf.")
    for name, thing in vars(module).items():
        if name.startswith("_") or getattr(thing, "__module__", None) != module.__name__:
            continue
        if inspect.isfunction(thing) and speaks(name, thing):
            yield f"{home}.{name}"
        elif inspect.isclass(thing):
            yield from (f"{home}.{name}.{member}" for member in members(thing))


def members(one):
    if getattr(one, "_is_protocol", False):
        return  # a promise: those who keep it have the derivative
    kinds = {f.name: f.type for f in dataclasses.fields(one)} if dataclasses.is_dataclass(one) else {}
    kinds |= {name: one.__annotations__[name] for name in getattr(one, "_fields", ())}
    for name, kind in kinds.items():
        if NAMED.search(name) and not name.startswith("_") and name_of(kind) not in PLAIN:
            yield name
    for name, member in vars(one).items():
        function = function_of(member)
        promised = getattr(function, "__isabstractmethod__", False)
        if function is not None and not promised and not name.startswith("_") and speaks(name, function):
            yield name


def name_of(kind):
    """An annotation is a string, a wrapped string or a class."""
    return getattr(kind, "__forward_arg__", getattr(kind, "__name__", kind))


def function_of(member):
    if isinstance(member, property):
        return member.fget
    if isinstance(member, cached_property):
        return member.func
    plain = getattr(member, "__func__", member)
    return plain if inspect.isfunction(plain) else None


def speaks(name, function):
    return NAMED.search(name) or SAID.search(function.__doc__ or "")


FOUND = {name for module in modules() for name in derivatives_in(module)}
CHECKED = {name for case in CASES for name in case.names}


def test_every_derivative_has_its_case():
    missing = sorted(FOUND - CHECKED - set(ELSEWHERE))
    assert missing == [], (
        f"add a case for each to {derivatives_of_bodies.__name__}, {derivatives_of_filters.__name__}, "
        f"{derivatives_of_inertial.__name__} or {derivatives_of_pendulum.__name__}"
    )


def thing_called(address):
    """What a dotted name stands for: the longest part of it that is a module, and the names within."""
    parts = address.split(".")
    root = address if parts[0] in ("tests", "benchmarks") else f"mbkf.{address}"
    for cut in range(len(parts) + 1, 1, -1):
        name = ".".join(root.split(".")[:cut])
        try:
            thing = importlib.import_module(name)
        except ModuleNotFoundError:
            continue
        for one in root.split(".")[cut:]:
            known = getattr(thing, "__dataclass_fields__", {})
            thing = known[one] if one in known else getattr(thing, one)
        return thing
    raise LookupError(address)


def test_no_case_outlives_what_it_checks():
    """What a case checks exists; it may check more than the search finds."""
    for address in CHECKED | set(ELSEWHERE):
        thing_called(address)
    assert not CHECKED & set(ELSEWHERE)


def test_blocks_have_their_cases_by_themselves():
    """Those of the package as well as those that tests bring."""
    own = {case.names[0] for case in CASES if case.compare.__module__ == derivatives_of_blocks.__name__}
    assert {
        "sensors.markers.Markers.linearise",
        "sensors.coordination.prior.CoordinationPrior.linearise",
    } <= own
    assert "tests.blocks.drifting_tracker.DriftingTracker.linearise" in own


def test_plants_have_their_cases_by_themselves():
    own = {case.names[0] for case in CASES if case.compare.__module__ == derivatives_of_plants.__name__}
    assert {"filters.dynamic.plant.SingerPlant.transition", "tests.plants.damped.Damped.transition"} <= own


@pytest.mark.parametrize("address", ELSEWHERE)
def test_what_is_checked_elsewhere_is_named_there(address):
    file, _, name = ELSEWHERE[address].partition(" ")
    name = name or address.split(".")[-1]
    assert re.search(rf"\b{name}\b", (TESTS / file).read_text(encoding="utf-8"))


def test_the_search_sees_what_it_should():
    made = types.ModuleType("mbkf.made.up")
    source = """
from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol
@dataclass
class Reading:
    value: float
    by_heat: list
    by_rows: int
    _rows: float
    @property
    def jacobian(self): "."
    @cached_property
    def change(self): "Its derivative by heat."
class Promise(Protocol):
    def transition(self, x): "."
class Plant:
    def transition(self, x): "."
    @abstractmethod
    def linearise(self, x): "."
    def predict(self, x): "."
    def _slope(self, x): "."
def jacobian_of(x): "."
def rises(x): "(n, n) sensitivity."
def rowing(x): "."
"""
    exec(source, vars(made))
    names = (
        "Reading.by_heat",
        "Reading.jacobian",
        "Reading.change",
        "Plant.transition",
        "jacobian_of",
        "rises",
    )
    assert set(derivatives_in(made)) == {f"made.up.{name}" for name in names}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_stated_derivatives_are_the_numeric_ones(case, seed):
    """Tolerances are shares of the largest entry, or absolute where that is below 1."""
    checked = case.compare(np.random.default_rng(seed))
    assert {*checked} == {*case.names}
    for address, (stated, numeric) in checked.items():
        assert np.shape(stated) == np.shape(numeric), address
        error = np.abs(np.asarray(stated) - numeric).max() / max(1.0, np.abs(numeric).max())
        assert error < case.tolerance, f"{address} differs by {error:.1e}"
        assert np.abs(numeric).max() > 1e-3, f"{address} is all zero here, which proves nothing"
