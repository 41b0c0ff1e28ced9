"""A person made for tests who stands, squats, walks or lifts the arms: the reference body in markers of reference36."""

from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.scaling.records import ScalingSettings
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.study.scaling.session import STANDING_FRAMES
from mbkf.trial.scale import scale

MASS_KG = 72.0
FRAMES = 30
RATE_HZ = 25.0


def posed(angles_deg, forward_m=0.0, frames=FRAMES, factor=1.0, moved_m=0.0) -> Capture:
    """A capture of the reference body, each joint flexed by its course.

    Args:
        angles_deg: By segment, forward flexion (frames,), degrees; knees backward.
        forward_m: How far the person goes.
        frames: Number of frames.
        factor: Size of the body.
        moved_m: Spread of the markers' places about those of the protocol.
    """
    model = HumanModel.scaled(dict.fromkeys(HumanModel.scaled().description.scale_factors, factor))
    markers = [one for one in load_protocol("reference36").markers if one.kind != "computed"]
    rng = np.random.default_rng(1)
    places = np.array([one.position_m for one in markers]) * factor + moved_m * rng.normal(
        size=(len(markers), 3)
    )
    sensor = MarkerSensor(model, [one.segment for one in markers], places)
    noise = np.random.default_rng(2).normal(0.0, 2e-4, (frames, len(markers), 3))
    positions = np.empty_like(noise)
    for n in range(frames):
        q = model.neutral()
        q[0], q[2] = forward_m * n / frames, 1.0
        for segment, course in angles_deg.items():
            backward = 1.0 if segment.endswith("shank") else -1.0
            turn = Rotation.from_euler("y", backward * np.radians(np.broadcast_to(course, frames)[n]))
            q[model.joint(segment).q] = turn.as_quat()
        positions[n] = sensor.positions(q)
    return Capture("", MarkerTrajectories(tuple(one.name for one in markers), positions + noise, RATE_HZ))


def both(segment, course):
    """A course of a segment of both sides."""
    return {f"right_{segment}": course, f"left_{segment}": course}


@cache
def standing() -> Capture:
    """Standing."""
    return posed({})


def squat(hip_deg=105.0, knee_deg=100.0, **changes) -> Capture:
    """Down and up once, on feet that stay below the pelvis no better than they must."""
    depth = np.sin(np.linspace(0.0, np.pi, FRAMES))
    return posed(both("thigh", hip_deg * depth) | both("shank", knee_deg * depth), **changes)


def walk(**changes) -> Capture:
    """Two strides."""
    phase = np.linspace(0.0, 4.0 * np.pi, FRAMES)
    swing = {side: 30.0 * np.sin(phase + shift) for side, shift in (("right", 0.0), ("left", np.pi))}
    bend = {
        side: 60.0 * np.maximum(np.cos(phase + shift), 0.0)
        for side, shift in (("right", 0.0), ("left", np.pi))
    }
    legs = {f"{side}_thigh": swing[side] for side in swing} | {f"{side}_shank": bend[side] for side in bend}
    return posed(legs, forward_m=2.0, **changes)


def arms_lifted() -> Capture:
    """Both arms forward and up, the legs at rest."""
    return posed(both("upper_arm", np.linspace(0.0, 150.0, FRAMES)))


@cache
def stander() -> Subject:
    """The person scaled from a few frames of standing."""
    return scale(standing(), mass_kg=MASS_KG, settings=ScalingSettings(frames_per_trial=STANDING_FRAMES))
