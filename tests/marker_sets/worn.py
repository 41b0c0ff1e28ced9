"""Synthetic persons that wear a protocol's markers, each placed a little beside its place, and the truth about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.io.records import MarkerTrajectories
from mbkf.model.sides import mirrored
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.synth import synthesise

FRAMES = 5
RATE_HZ = 100.0
NOISE_M = 0.0005
ARMS_AWAY_RAD = 0.25
"""Arms hang beside the body, not through it."""


@dataclass(frozen=True)
class Worn:
    """Markers on a person.

    Attributes:
        markers: Where they were seen.
        segments: The segment of each, by name; "" for a point that is no part of the body.
    """

    markers: MarkerTrajectories
    segments: dict[str, str]

    @property
    def points_m(self) -> np.ndarray:
        """(K, 3) the first frame."""
        return self.markers.positions_m[0]

    def share_right(self, found: Sequence) -> float:
        """Share of inferred markers that are on their segment, or across the joint that they are near."""
        assert [one.name for one in found] == list(self.markers.names)
        return float(np.mean([near(one.segment, self.segments[one.name]) for one in found]))

    def moved(self, change: Callable[[np.ndarray], np.ndarray]) -> Worn:
        """The same with other positions."""
        return replace(self, markers=replace(self.markers, positions_m=change(self.markers.positions_m)))

    def turned(self, angle_rad: float, shift_m: Sequence[float] = (0.0, 0.0, 0.0)) -> Worn:
        """The same turned about the vertical, then shifted."""
        turn = Rotation.from_euler("z", angle_rad).as_matrix()
        return self.moved(lambda points: points @ turn.T + shift_m)

    def mirrored(self) -> Worn:
        """The mirror image: what was on the right is on the left."""
        worn = self.moved(lambda points: points * [1.0, -1.0, 1.0])
        return replace(worn, segments={name: mirrored(one) for name, one in self.segments.items()})

    def beside(self, points_m: np.ndarray) -> Worn:
        """With further points that rest in the laboratory, (n, 3)."""
        names = tuple(f"X{k}" for k in range(len(points_m)))
        rest = np.broadcast_to(points_m, (self.markers.frames, *points_m.shape))
        positions = np.concatenate([self.markers.positions_m, rest], axis=1)
        markers = replace(self.markers, names=(*self.markers.names, *names), positions_m=positions)
        return Worn(markers, {**self.segments, **dict.fromkeys(names, "")})


NEIGHBOURS = (
    {"thigh", "shank"},
    {"shank", "foot"},
    {"foot", "toes"},
    {"upper_arm", "forearm"},
    {"forearm", "hand"},
)


def near(one: str, other: str) -> bool:
    """Whether two segments are the same, or neighbours of one limb: a marker may sit on the line of their joint."""
    side, _, part = one.partition("_")
    other_side, _, other_part = other.partition("_")
    return one == other or (side == other_side and {part, other_part} in NEIGHBOURS)


@cache
def standing(
    protocol: str = "reference36",
    seed: int = 1,
    without: tuple[str, ...] = (),
    height_m: float | None = None,
) -> Worn:
    """A person who stands still.

    Args:
        protocol: The markers.
        seed: Chooses the person, the places and the noise.
        without: Segments that carry none, by the end of their names.
        height_m: Height; a random one when None.
    """
    subject = synthesise_subject(seed, protocol, height_m=height_m)
    model = body_of(subject)
    worn = [marker for marker in subject.markers if not marker.segment.endswith(without or ("-",))]
    sensor = MarkerSensor(model, [m.segment for m in worn], np.array([m.position_m for m in worn]))
    rng = np.random.default_rng([seed, 9])
    q = model.integrate(model.neutral(), 0.3 * model.posture_sd * rng.uniform(-1.0, 1.0, model.nv))
    for arm, sense in (("right_upper_arm", -1.0), ("left_upper_arm", 1.0)):
        q[model.joint(arm).q] = Rotation.from_euler("x", sense * ARMS_AWAY_RAD).as_quat()
    points = sensor.positions(q)
    points = points + np.array([0.4, -0.3, 0.05 - points[:, 2].min()])
    positions = points + rng.normal(0.0, NOISE_M, (FRAMES, *points.shape))
    names = tuple(marker.name for marker in worn)
    return Worn(
        MarkerTrajectories(names, positions, RATE_HZ), {marker.name: marker.segment for marker in worn}
    )


@cache
def walking(protocol: str = "reference36", seed: int = 1, skin_sd_m: float = 0.003) -> tuple[Worn, Worn]:
    """A person who stands, and who walks.

    Args:
        protocol: The markers.
        seed: Chooses the person, the walk and the errors.
        skin_sd_m: How far the skin moves, per coordinate.
    """
    subject = synthesise_subject(seed, protocol)
    settings = CaptureSettings(skin_sd_m=skin_sd_m, occlusion=0.0)
    _, made = synthesise("walk", seconds=1.5, seed=seed, settings=settings, subject=subject)
    segments = {marker.name: marker.segment for marker in subject.markers}
    return Worn(made.static.markers, segments), Worn(made.trial.markers, segments)


BOX_M = np.array([[0.0, 0.0, 0.2], [0.4, 0.0, 0.2], [0.0, 0.3, 0.2], [0.4, 0.3, 0.5]])
"""Markers on a box."""


def box_at(x_m: float, y_m: float, z_m: float) -> np.ndarray:
    """(4, 3) the box somewhere."""
    return BOX_M + np.array([x_m, y_m, z_m])
