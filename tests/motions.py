"""Bodies, poses, analytic motions and finite differences shared by the tests of model, sensors, scaling and filters."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.filters.record import Track
from mbkf.io.dimensions import shape_of
from mbkf.io.quantities import quantities
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.block import Frame
from mbkf.sensors.marker_sensor import MarkerSensor


@cache
def reference_model():
    return HumanModel.scaled()


def random_scale(rng, spread=0.1):
    """(18,) scale factors; pelvis and torso share their vertical one."""
    found = rng.uniform(1 - spread, 1 + spread, 17)
    return np.append(found, found[2])


def random_model(rng, spread=0.1):
    body = reference_model().description
    return HumanModel(body, random_scale(rng, spread), rng.uniform(50, 110))


def moderate_pose(model, rng, spread=0.5, heading=None):
    """Joints within ``spread`` × their everyday range, the pelvis somewhere, upright, facing anywhere."""
    step = spread * model.posture_sd * rng.uniform(-1, 1, model.nv)
    q = model.integrate(model.neutral(), step)
    q[:3] = rng.uniform(-1, 1, 3)
    yaw = rng.uniform(-np.pi, np.pi) if heading is None else heading
    q[3:7] = (Rotation.from_euler("z", yaw) * Rotation.from_rotvec(rng.uniform(-0.15, 0.15, 3))).as_quat()
    return q


def central_difference(model, function: Callable, q, step=1e-6):
    """Derivative of function(q) along every tangent direction, appended as the last axis."""
    columns = [
        (np.asarray(function(model.integrate(q, step * e))) - function(model.integrate(q, -step * e)))
        / (2 * step)
        for e in np.eye(model.nv)
    ]
    return np.stack(columns, axis=-1)


@dataclass(frozen=True)
class SmoothMotion:
    """Every joint swings about an axis of its own and the pelvis travels, with v and a known in closed form.

    A rotation about a fixed axis u by θ(t) has ω = u θ̇ and ω̇ = u θ̈ in the joint's own frame, exactly.
    """

    model: HumanModel
    axes: np.ndarray  # (nv,) unit axis per joint; the root's first three are its travel
    swing: np.ndarray  # (nv,) amplitude, the same for all dofs of a joint
    frequency_hz: np.ndarray  # (nv,), likewise
    phase: np.ndarray  # (nv,), likewise

    def _angles(self, t, derivative=0):
        w = 2 * np.pi * self.frequency_hz
        return self.swing * w**derivative * np.sin(w * t + self.phase + derivative * np.pi / 2)

    def q(self, t):
        rotation = self.axes * self._angles(t)
        q = self.model.integrate(self.model.neutral(), np.where(np.arange(self.model.nv) < 3, 0.0, rotation))
        q[:3] = rotation[:3]
        return q

    def v(self, t):
        v = self.axes * self._angles(t, 1)
        v[:3] = self._pelvis(t).T @ v[:3]
        return v

    def a(self, t):
        a, v = self.axes * self._angles(t, 2), self.v(t)
        a[:3] = self._pelvis(t).T @ a[:3] - np.cross(v[3:6], v[:3])
        return a

    def _pelvis(self, t):
        return Rotation.from_quat(self.q(t)[3:7]).as_matrix()

    def frames(self, count, rate_hz):
        """q, v, a over ``count`` frames."""
        times = np.arange(count) / rate_hz
        return tuple(np.array([part(t) for t in times]) for part in (self.q, self.v, self.a))


def smooth_motion(model, rng, swing_rad=0.3, travel_m=0.15, frequency_hz=(0.5, 1.2)):
    axes, swing, frequency, phase = (np.zeros(model.nv) for _ in range(4))
    parts = [(slice(0, 3), travel_m), (slice(3, 6), swing_rad)]
    parts += [(slice(i, i + 1), 0.3 * swing_rad) for i in range(*model.joint("neck").v.indices(model.nv))]
    parts += [(j.v, swing_rad) for j in model.joints.values() if j.kind in ("spherical", "hinge")]
    for dofs, amplitude in parts:
        direction = rng.normal(size=dofs.stop - dofs.start)
        axes[dofs] = direction / np.linalg.norm(direction)
        swing[dofs] = amplitude * rng.uniform(0.5, 1.0)
        frequency[dofs] = rng.uniform(*frequency_hz)
        phase[dofs] = rng.uniform(-np.pi, np.pi)
    return SmoothMotion(model, axes, swing, frequency, phase)


def protocol_sensor(model, protocol="reference36", keep=None):
    """Sensor of a protocol's markers at their reference places on a scaled body, and their names."""
    markers = [m for m in load_protocol(protocol).markers if keep is None or m.name in keep]
    scale = np.array([model.axis_scale(model.description.segment(m.segment)) for m in markers])
    local = scale * np.array([m.position_m for m in markers])
    return MarkerSensor(model, [m.segment for m in markers], local), tuple(m.name for m in markers)


def subject_of(model, session_sd_m=0.005, aliases=None):
    """The person a model is, with the reference markers exactly in place."""
    sensor, names = protocol_sensor(model)
    markers = tuple(
        SubjectMarker(name, segment, position, 0.005, session_sd_m, (aliases or {}).get(name, ()))
        for name, segment, position in zip(names, sensor.segments, sensor.local_m, strict=True)
    )
    factors = dict(zip(model.description.scale_factors, map(float, model.scale), strict=True))
    return Subject("human18", model.mass_kg, factors, markers, "reference36")


def marker_positions(sensor, qs):
    return np.array([sensor.positions(q) for q in qs])


def capture_of(names, positions_m, rate_hz=100.0, plates=(), mass_kg=None):
    markers = MarkerTrajectories(tuple(names), positions_m, rate_hz)
    return Capture("made.c3d", markers, plates=tuple(plates), subject_mass_kg=mass_kg)


def angle_errors(model, found, true):
    """(T, nv) tangent differences between two motions."""
    return np.array([model.difference(a, b) for a, b in zip(true, found, strict=True)])


def markers_only(markers_m):
    """A frame in which only cameras read."""
    return Frame(markers_m, np.zeros((0, 6)))


def worst(values):
    return float(np.abs(values).max())


def assert_near(found, expected, tolerance):
    """Equal within an absolute tolerance and nothing else."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance)


def track_of(q, v, a, **known):
    """A followed trial with this motion; what is not given is 0, as if everything were known exactly; no wrench."""
    frames = len(a)
    sizes = {"time": frames, "dof": a.shape[1], "coordinate": a.shape[1], "marker": 0, "part": 0, "ball": 15}
    fields = {
        name: np.zeros(shape_of(one.axes, sizes), one.dtype)
        for name, one in quantities(Track).items()
        if name not in ("q", "v", "a", "foot_contact", "covariance", "level_sd", "level_offset")
    }
    for name in ("wrench", "wrench_sd", "support", "support_sd"):
        fields[name][:] = np.nan
    for name in ("tracked", "known"):
        fields[name][:] = True
    return Track(**{"q": q, "v": v, "a": a, "starts": (0,), "smoothed": False, **fields, **known})
