"""A short true squat through every filter, for the tests of filters and of what is made of their tracks."""

from copy import copy
from dataclasses import replace
from functools import cache

import numpy as np

from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.estimate import Recording
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.inverse_dynamics import inverse_dynamics
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.filters.tracking import track
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.preparation.filters import FilterInputs, tracking_filter
from tests.dynamics import DT, MARKER_SD_M, trial
from tests.motions import angle_errors, marker_positions

FRAMES = range(40, 100)
"""Frames of the squat: it goes down."""

WHOLE = SmoothingSettings(window_s=10.0)
"""The whole run in one stretch."""

SETTLED = slice(15, -5)
"""Frames of a run in which a filter no longer settles, and later ones follow."""


def made():
    return trial("squat")


def inputs(plates=None, **changes):
    """What filters of the true body know; ``plates`` are both unless given, ``changes`` replace fields."""
    m = made()
    segments = [marker.segment for marker in m.subject.markers]
    sensor = MarkerSensor(m.model, segments, np.array([marker.position_m for marker in m.subject.markers]))
    known = FilterInputs(
        sensor,
        np.full(len(segments), MARKER_SD_M),
        m.plates if plates is None else plates,
        DT,
        np.zeros(m.model.nv, dtype=bool),
        KinematicSettings(),
        DynamicSettings(),
        TorqueSettings(),
    )
    return replace(known, **changes)


def made_filter(name, **changes):
    return tracking_filter(name, inputs(**changes))


@cache
def recording(frames=FRAMES, seed=0):
    """Markers with white noise and plates with a newton of it."""
    rng, m = np.random.default_rng(seed), made().motion
    some = slice(frames.start, frames.stop)
    markers = marker_positions(inputs().sensor, m.q[some])
    markers = markers + MARKER_SD_M * rng.normal(size=markers.shape)
    return Recording(markers, m.foot_wrench[some] + rng.normal(size=(len(frames), 2, 6)), DT)


def without(read, frames, markers=slice(None)):
    """The recording with these markers missing in these frames."""
    seen = read.markers_m.copy()
    seen[frames, markers] = np.nan
    return replace(read, markers_m=seen)


@cache
def tracked(name, smoothing=None):
    """The short run through a filter."""
    return track(replayed(name), recording(), smoothing=smoothing, keep_covariance=True)


@cache
def estimates(name):
    """The filter's estimates of the short run, with the filter."""
    one = made_filter(name)
    found = [one.start(recording(), 0, None)]
    for t in range(1, len(FRAMES)):
        found.append(one.step(found[-1], recording(), t))
    return one, found


def replayed(name):
    """The filter, which answers each frame of the short run with the estimate that it found before."""
    one, found = estimates(name)
    again = copy(one)
    again.start = lambda read, t, guess: found[t]
    again.step = lambda before, read, t, prediction=None: found[t]
    return again


def torques(found, read=None):
    """(T, nv) of a track under its own wrenches, or the measured ones where it has none."""
    wrench = (read or recording()).plates if np.isnan(found.wrench).all() else found.wrench
    return inverse_dynamics(made().model, found, wrench).tau


def errors(found, inside=SETTLED, frames=FRAMES):
    """RMS errors of joint angles, velocities and torques against the truth."""
    m, some = made().motion, slice(frames.start, frames.stop)
    angle = angle_errors(made().model, found.q, m.q[some])
    parts = (angle, found.v - m.v[some], torques(found, recording(frames)) - m.tau[some])
    return np.array([np.sqrt(np.mean(part[inside, 6:] ** 2)) for part in parts])
