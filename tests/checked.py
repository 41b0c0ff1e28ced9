"""A true walk and a true squat with what plates and markers read of them, for tests of checks."""

from dataclasses import replace
from functools import cache

import numpy as np

from mbkf.model.human import HumanModel
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.preparation.markers_alone import Motion
from tests.dynamics import trial

QUIET = CaptureSettings(markers_sd_m=0.001, skin_sd_m=0.0, occlusion=0.0, offset_n=(0.0, 0.0))


@cache
def recorded(name="walk"):
    """The capture."""
    made = trial(name)
    return synthesise_capture(made.subject, made.motion, QUIET, seed=1).trial


def plates(name="walk"):
    """Those of the trial that are ever loaded."""
    return tuple(plate for plate in recorded(name).plates if plate.force_n[:, 2].max() > 100.0)


def motion(name="walk"):
    """The true motion."""
    return Motion(trial(name).motion.q, trial(name).motion.v)


def body(name="walk", mass=1.0):
    """The body, with a mass that is wrong by a factor."""
    model = trial(name).model
    return HumanModel(model.description, model.scale, mass * model.mass_kg)


def evidence(name="walk", mass=1.0, read=None):
    """Both sides of Newton's law from the true motion."""
    markers = recorded(name).markers
    given = plates(name) if read is None else read
    return Evidence.of(body(name, mass), motion(name), markers.times_s, markers.rate_hz, given)


def amplified(read, gains):
    """Plates with wrong gains, one each."""
    return tuple(
        replace(plate, force_n=gain * plate.force_n, moment_nm=gain * plate.moment_nm)
        for plate, gain in zip(read, gains, strict=True)
    )


def nothing(found):
    """(T,) frames in which parts besides the feet bear: none."""
    return np.zeros(len(found.times_s), dtype=bool)
