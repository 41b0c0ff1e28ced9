"""Tuning finds the noise that simulated trials were made with, and says what held-out readings make of it."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.study.tune import TuneSettings, tune
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings

pytestmark = pytest.mark.slow

RATE_HZ, NOISE_M = 100.0, 0.002
MOTION, STATED = 0.1, 0.5
"""True factor on accelerations; the subject states this share of the true marker noise."""

BARE = ReconstructSettings(
    correct_markers=False,
    kinematic=KinematicSettings(posture_scale=1e6, velocity_sd=1e6, gate=1e9, gate_radius_m=10.0),
)


@pytest.fixture(scope="module")
def subject():
    made = synthesise_subject(5)
    return replace(made, markers=tuple(replace(m, noise_m=STATED * NOISE_M) for m in made.markers))


@pytest.fixture(scope="module")
def model(subject):
    return body_of(subject)


def simulated(subject, model, frames, seed):
    """Markers of a body that the kinematic filter's own plant moves."""
    rng = np.random.default_rng(seed)
    sensor = MarkerSensor(
        model, [m.segment for m in subject.markers], np.array([m.position_m for m in subject.markers])
    )
    q, v, dt = model.neutral(), np.zeros(model.nv), 1.0 / RATE_HZ
    positions = []
    for _ in range(frames):
        a = MOTION * model.acceleration_sd * rng.normal(size=model.nv)
        q = model.integrate(q, dt * v + 0.5 * dt**2 * a)
        v = v + dt * a
        positions.append(sensor.positions(q))
    measured = np.array(positions) + NOISE_M * rng.normal(size=(frames, len(sensor.segments), 3))
    names = tuple(m.name for m in subject.markers)
    return Capture(f"trial{seed}.c3d", MarkerTrajectories(names, measured, RATE_HZ), ())


@pytest.fixture(scope="module")
def trial(subject, model):
    return simulated(subject, model, 160, 1)


def kinematic(**changes):
    return TuneSettings(**{"filter": "kinematic", "reconstruct": BARE, "calls": 40} | changes)


def test_the_noise_of_a_simulation_is_found(subject, trial):
    stages = []
    found = tune(
        [trial],
        subject,
        settings=kinematic(),
        progress=lambda name, done, total: stages.append((done, total)),
    )
    motion, markers = found.parameters
    assert motion.factor == pytest.approx(MOTION, rel=0.15)
    assert markers.factor == pytest.approx(1.0 / STATED, rel=0.1)
    assert motion.determined
    assert markers.determined
    assert found.values["marker_noise_scale"] == pytest.approx(markers.factor, rel=0.01)
    assert found.better
    assert found.likelihood["tuned_after"] > found.likelihood["tuned_before"]
    assert (found.tuned_on, found.held_out) == (("trial1, first half",), ("trial1, second half",))
    assert stages[-1][0] == stages[-1][1] == found.calls
    saved = found.preset("lab")
    assert (saved.values, saved.found, saved.filter) == ({**found.start, **found.values}, {}, "kinematic")
    assert found.start == {"gate": 1e9, "gate_radius_m": 10.0, "posture_scale": 1e6, "velocity_sd": 1e6}


def test_trials_are_held_out_by_position(subject, model):
    trials = [simulated(subject, model, 80, seed) for seed in (2, 3)]
    last = tune(trials, subject, settings=kinematic(calls=2, parameters=("markers",)))
    assert (last.tuned_on, last.held_out) == (("trial2",), ("trial3",))
    assert not last.settled
    assert any("--runs" in warning for warning in last.warnings)
    first = tune(trials, subject, settings=kinematic(calls=2, parameters=("markers",), hold_out=(0,)))
    assert (first.tuned_on, first.held_out) == (("trial3",), ("trial2",))
    assert first.likelihood["held_out_before"] == pytest.approx(last.likelihood["tuned_before"])


def test_the_dynamic_filter_is_tuned_without_plates(subject, trial):
    settings = TuneSettings(parameters=("motion", "plates"), calls=3, reconstruct=BARE)
    found = tune([trial], subject, settings=settings)
    motion, plates = found.parameters
    assert not plates.determined
    assert found.values["plate_force_n"] == found.defaults["plate_force_n"]
    assert any("'plates' is not determined" in warning for warning in found.warnings)
    assert motion.determined


@pytest.mark.parametrize(
    ("changes", "error", "fragment"),
    [
        ({"filter": "torque"}, UnknownName, "'torque'"),
        ({"parameters": ("motoin",)}, UnknownName, "did you mean motion"),
        ({"parameters": ()}, InvalidInput, "motion"),
        ({"hold_out": (0,)}, InvalidInput, "every trial is held out"),
    ],
)
def test_what_cannot_be_tuned(changes, error, fragment, subject, trial):
    with pytest.raises(error, match=fragment):
        tune([trial], subject, settings=kinematic(**changes))


def test_trials_that_cannot_be_used(subject, trial):
    with pytest.raises(InvalidInput, match="at least one"):
        tune([], subject, settings=kinematic())
    short = replace(trial, markers=replace(trial.markers, positions_m=trial.markers.positions_m[:90]))
    with pytest.raises(InvalidInput, match="trial1, first half' is too short"):
        tune([short], subject, settings=kinematic())
    nowhere = replace(trial, markers=replace(trial.markers, positions_m=trial.markers.positions_m[:40, ::-1]))
    with pytest.raises(NotObservable, match="in no frame"):
        tune([nowhere], subject, settings=kinematic())


def test_inputs_are_those_of_a_reconstruction(subject, trial):
    shown = subject_markers(trial.markers, subject)
    inputs, recording = trial_inputs(shown, trial.plates, subject, BARE)
    assert len(recording) == 160
    assert recording.plates.shape == (160, 0, 6)
    np.testing.assert_array_equal(inputs.noise_m, STATED * NOISE_M)
    np.testing.assert_array_equal(recording.markers_m, trial.markers.positions_m)
    assert not inputs.unobservable.any()
