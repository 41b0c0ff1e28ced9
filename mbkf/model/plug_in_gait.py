"""Plug-in Gait's axes on a body: pelvis, thighs, shanks, feet and thorax from the places of its markers.

R. B. Davis et al., Hum. Mov. Sci. 10 (1991) 575-587 (hip centres); M. P. Kadaba et al., J. Orthop. Res. 8 (1990)
383-392 (wands); Vicon's Plug-in Gait reference guide (offsets). With the markers of a frame in place of a posture's,
the formulas give the axes that Vicon stored in three persons' files to 0.01° (shanks with a tilted ankle: 2.8°). A
shank has two sets of axes: the knee's flexion is about an axis that tibial torsion turns away from the ankle's. A foot
is a line, from the ankle centre to the forefoot, which then turns by the static trial's offsets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mbkf.conventions import Array
from mbkf.model.angle_reading import AngleReading, JointAxes, Line
from mbkf.numerics.orthonormal import axes_from

MARKER_RADIUS_M = 0.007
"""Half of Plug-in Gait's 14 mm, whatever diameter a file states."""

HIP_ANGLES_RAD = (0.5, 0.314)
"""θ and β of Davis' regression."""

ANGLE_NAMES = (
    "THIGHROTATION", "SHANKROTATION", "TIBIALTORSION", "ANKLEABADD", "STATICPLANTFLEX", "STATICROTOFF",
)  # fmt: skip
"""Angles of a file's PROCESSING group, without their sides."""

THORAX = ("c7", "t10", "jugular_notch", "xiphoid")
"""Places of the thorax's markers C7, T10, CLAV and STRN."""

JOINT_SIDES = {"r": ("R", "right"), "l": ("L", "left")}

_TOLERANCE_RAD, _MOST_STEPS = 1e-9, 100


@dataclass(frozen=True)
class Measured:
    """Measurements of a person that a laboratory gave Plug-in Gait; None where unknown.

    Attributes:
        leg_m, knee_m, ankle_m: Length of each leg, widths of knees and ankles, right and left.
        hip_depth_m: ASIS to greater trochanter, front to back.
        asis_m: Distance of the two ASIS.
        thigh_rad, shank_rad: Offset angles of the wands.
        torsion_rad, ankle_tilt_rad: Tibial torsion, and tilt of the ankle's axis.
        foot_rad: (plantar flexion, rotation) of the line of the foot in the static trial.
    """

    leg_m: tuple[float | None, float | None]
    knee_m: tuple[float | None, float | None]
    ankle_m: tuple[float | None, float | None]
    hip_depth_m: tuple[float | None, float | None]
    asis_m: float | None
    thigh_rad: tuple[float, float]
    shank_rad: tuple[float, float]
    torsion_rad: tuple[float, float]
    ankle_tilt_rad: tuple[float, float]
    foot_rad: tuple[tuple[float, float] | None, tuple[float, float] | None]


def measured_of(stored: Mapping[str, float]) -> Measured:
    """The measurements in a file's PROCESSING group, whose lengths are in mm.

    Angles are in rad; in degrees, all of a file's, where one is larger than a right angle would be in rad.
    """
    sided = [stored.get(side + name, 0.0) for side in "RL" for name in ANGLE_NAMES]
    turn = 1.0 if max(map(abs, sided)) <= 0.5 * np.pi else np.pi / 180.0

    def length(name: str) -> float | None:
        value = stored.get(name, 0.0)
        return 1e-3 * value if value > 0.0 else None

    def lengths(name: str) -> tuple[float | None, float | None]:
        return length("R" + name), length("L" + name)

    def angles(name: str) -> tuple[float, float]:
        return turn * stored.get("R" + name, 0.0), turn * stored.get("L" + name, 0.0)

    def foot(side: str) -> tuple[float, float] | None:
        names = (side + "STATICPLANTFLEX", side + "STATICROTOFF")
        known = all(name in stored for name in names)
        return (turn * stored[names[0]], turn * stored[names[1]]) if known else None

    return Measured(
        lengths("LEGLENGTH"),
        lengths("KNEEWIDTH"),
        lengths("ANKLEWIDTH"),
        lengths("ASISTROCANTERDISTANCE"),
        length("INTERASISDISTANCE"),
        angles("THIGHROTATION"),
        angles("SHANKROTATION"),
        angles("TIBIALTORSION"),
        angles("ANKLEABADD"),
        (foot("R"), foot("L")),
    )


def plug_in_gait(places: Mapping[str, Array], measured: Measured) -> AngleReading:
    """The convention for a person.

    Args:
        places: (3,) places in the body's neutral posture, in which all segments' frames are the world's, m:
            ``asis``, ``knee``, ``knee_medial``, ``ankle``, ``ankle_medial``, ``heel``, ``toe``, ``knee_centre`` and
            ``ankle_centre`` with ``right_`` and ``left_`` before them, ``sacrum``, where there are wands
            ``thigh_wand`` and ``shank_wand``, and for the thorax all of :data:`THORAX`.
        measured: Measurements of the person.
    """
    pelvis, hips = _pelvis(places, measured)
    joints = {"pelvis": JointAxes(np.eye(3), pelvis)}
    for n, (suffix, (_, side)) in enumerate(JOINT_SIDES.items()):
        leg = _Leg(
            {name.removeprefix(f"{side}_"): p for name, p in places.items() if name.startswith(side)},
            n,
            measured,
        )
        thigh, knee_centre = leg.thigh(hips[n])
        shank, torsioned, ankle_centre = leg.shank(knee_centre)
        line, foot = leg.foot(shank, ankle_centre)
        joints[f"hip_{suffix}"] = JointAxes(pelvis, thigh)
        joints[f"knee_{suffix}"] = JointAxes(thigh, shank)
        joints[f"ankle_{suffix}"] = JointAxes(torsioned, foot, "yzx", Line(shank, line))
    return AngleReading("pig", joints, _thorax(places) if places.keys() >= set(THORAX) else None)


def _thorax(places: Mapping[str, Array]) -> Array:
    """Axes of the thorax: up between the lower and the upper pair of markers, forward from the back to the front."""
    c7, t10, notch, xiphoid = (places[name] for name in THORAX)
    return axes_from("z", c7 + notch - t10 - xiphoid, "x", notch + xiphoid - c7 - t10)


def _pelvis(places: Mapping[str, Array], measured: Measured) -> tuple[Array, tuple[Array, Array]]:
    """Axes of the pelvis and the hip centres, right and left."""
    right, left = places["right_asis"], places["left_asis"]
    middle = 0.5 * (right + left)
    axes = axes_from("y", left - right, "x", middle - places["sacrum"])
    legs = [measured.leg_m[n] or _leg_length(places, side) for n, side in enumerate(("right", "left"))]
    theta, beta = HIP_ANGLES_RAD
    C = 0.115 * float(np.mean(legs)) - 0.0153
    half = 0.5 * (measured.asis_m or float(np.linalg.norm(left - right)))
    centres = []
    for n, side in enumerate((-1.0, 1.0)):
        behind = (measured.hip_depth_m[n] or 0.1288 * legs[n] - 0.04856) + MARKER_RADIUS_M
        local = np.array([
            C * np.cos(theta) * np.sin(beta) - behind * np.cos(beta),
            side * (half - C * np.sin(theta)),
            -C * np.cos(theta) * np.cos(beta) - behind * np.sin(beta),
        ])  # fmt: skip
        centres.append(middle + axes @ local)
    return axes, (centres[0], centres[1])


def _leg_length(places: Mapping[str, Array], side: str) -> float:
    """From ASIS past the knee to the inner ankle, as with a tape."""
    stations = [places[f"{side}_{name}"] for name in ("asis", "knee_medial", "ankle_medial")]
    return float(sum(np.linalg.norm(b - a) for a, b in pairwise(stations)))


@dataclass(frozen=True)
class _Leg:
    """One leg's places, its number (0 right, 1 left) and the person's measurements."""

    places: Mapping[str, Array]
    number: int
    measured: Measured

    @property
    def side(self) -> float:
        """1 where y points outward (left), −1 on the right."""
        return 1.0 if self.number else -1.0

    def thigh(self, hip: Array) -> tuple[Array, Array]:
        """Axes of the thigh and the knee's centre."""
        offset = self.measured.thigh_rad[self.number] if "thigh_wand" in self.places else 0.0
        return self._chord("knee", "thigh_wand", hip, self.measured.knee_m[self.number], offset, 0.0)

    def shank(self, knee: Array) -> tuple[Array, Array, Array]:
        """Axes of the shank at the knee and at the ankle, and the ankle's centre."""
        n, wand = self.number, "shank_wand" in self.places
        offset, tilt = (self.measured.shank_rad[n], self.measured.ankle_tilt_rad[n]) if wand else (0.0, 0.0)
        at_ankle, centre = self._chord("ankle", "shank_wand", knee, self.measured.ankle_m[n], offset, tilt)
        torsion = self.side * self.measured.torsion_rad[n]
        from scipy.spatial.transform import Rotation  # loads slowly, and few results need it

        return at_ankle @ Rotation.from_euler("Z", torsion).as_matrix(), at_ankle, centre

    def foot(self, shank: Array, ankle: Array) -> tuple[Array, Array]:
        """Axes along the line from ankle centre to forefoot, and those that the static trial makes of them."""
        from scipy.spatial.transform import Rotation

        toe = self.places["toe"]
        line = axes_from("x", toe - ankle, "y", shank[:, 1])
        known = self.measured.foot_rad[self.number]
        if known is not None:
            flexion, rotation = -known[0], -self.side * known[1]
        else:  # the sole stands flat, and the foot points from heel to forefoot
            sole = (toe - self.places["heel"]) * np.array([1.0, 1.0, 0.0])
            x, y, z = line.T @ sole
            flexion, rotation = float(np.arctan2(-z, x)), float(np.arctan2(y, np.hypot(x, z)))
        return line, line @ Rotation.from_euler("YZ", [flexion, rotation]).as_matrix()

    def _chord(
        self, joint: str, wand: str, top: Array, width_m: float | None, offset: float, tilt: float
    ) -> tuple[Array, Array]:
        """Axes of a segment with z to its upper joint and y through the marker of the lower, and that joint's centre.

        The centre lies half a width from the marker, at a right angle to the segment but for a tilt, and so that the
        wand stands off the marker by an offset about the segment.
        """
        marker = self.places[joint]
        if width_m is None:
            away = float(np.linalg.norm((marker - self.places[f"{joint}_centre"])[:2]))
        else:
            away = 0.5 * width_m + MARKER_RADIUS_M
        beside = self.places[wand] if wand in self.places else 2.0 * marker - self.places[f"{joint}_medial"]
        length = np.linalg.norm(top - marker)
        up = (top - marker) / length
        right_angle = 0.5 * np.pi + self.side * tilt
        at_marker = np.pi - right_angle - np.arcsin(away * np.sin(right_angle) / length)
        ahead = np.cross(up, beside - marker)
        ahead /= np.linalg.norm(ahead)
        out, turned, wanted = np.cross(ahead, up), 0.0, self.side * offset
        for _ in range(_MOST_STEPS):
            inward = -np.cos(turned) * out - np.sin(turned) * ahead
            centre = marker + away * (np.cos(at_marker) * up + np.sin(at_marker) * inward)
            axes = axes_from("z", top - centre, "y", self.side * (marker - centre))
            wand_x, wand_y, _ = (beside - centre) @ axes
            off = float(np.arctan2(-self.side * wand_x, self.side * wand_y)) - wanted
            turned += off
            if abs(off) < _TOLERANCE_RAD:
                break
        return axes, centre
