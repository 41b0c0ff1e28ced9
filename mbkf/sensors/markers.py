"""Markers on the body, as a block: z_m = p_m(q) + r, r ~ N(0, c σ_m² I₃) for every marker m that passes its gate.

p_m is the marker's place on its segment (:mod:`mbkf.sensors.marker_sensor`), σ_m its noise, and c a factor that follows
the innovations. Skin moves slowly, so that the next frames repeat an error, and a frame counts for a share s of an
independent reading only:

    c ← c + (1 − e^(−Δt/T)) (clip(yᵀR⁻¹y / (3 m s)) − c)

Lasting noise is replaced by white noise σ_m of equal weight (:mod:`mbkf.sensors.lasting_noise`). One frame then shows
only the noise's own spread e_m, and s is (e_m/σ_m)² of each such marker.

The part of the innovations that does not last is white noise of the cameras, estimated from the readings
(:mod:`mbkf.sensors.white_noise`). For quiet cameras and skin c is at its least, and errors are smaller than it states.

The innovation gate is that of :mod:`mbkf.sensors.gating`. If all seen markers of a segment lie elsewhere than
predicted, its joint's spread is inflated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import exp
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.kernel.markers import Innovations, innovations
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import NO_DOFS, Block, Channels, Frame, Notes, OperatingPoint, State
from mbkf.sensors.gating import TRACK_LOSS_M, ObservedDofs, gated
from mbkf.sensors.marker_sensor import JacobianInformation, MarkerInformation, MarkerReading, MarkerSensor
from mbkf.sensors.skin import SkinMarkers
from mbkf.sensors.states import AcceleratedState
from mbkf.sensors.white_noise import WhiteNoise

DISPLACED_SD_RAD = 0.5
DISPLACED_SD_RAD_S = 3.0
"""Error of a joint's position and velocity whose segment comes back into sight elsewhere than predicted."""


@dataclass(frozen=True)
class MarkerSettings:
    """Noise and gate of the markers.

    Attributes:
        marker_noise_scale: Factor on the markers' own noise. Raise it for loose clothing.
        innovation_share: Share s of an independent reading for which a frame's marker counts; the noise then follows
            the innovations within ``noise_range``. 0 keeps the markers' own noise (white camera noise only). Set on
            synthetic trials with 3 to 5 mm of skin so that 95 % intervals cover.
        noise_memory_s: Time T over which the mean square innovation is taken.
        noise_range: Least and greatest factor on the markers' noise.
        gate: Squared Mahalanobis distance (3 readings) above which a marker is not used.
        gate_radius_m: Distance below which every marker is used, m.
        skin_memory_s: Correlation time of a marker's skin artefact as a Gauss–Markov process with the marker's noise as
            its spread (:mod:`mbkf.sensors.skin`); 0 for white noise.
        camera_noise_m: White noise besides the artefact.
        min_markers: Fewer used markers than this leave the body untracked.
    """

    marker_noise_scale: float = 1.0
    innovation_share: float = field(default=0.12, metadata={"zero": True})
    noise_memory_s: float = 1.0
    noise_range: tuple[float, float] = (0.5, 4.0)
    gate: float = 60.0
    gate_radius_m: float = 0.03
    skin_memory_s: float = field(default=0.0, metadata={"zero": True})
    camera_noise_m: float = 0.001
    min_markers: int = 6


LEAST_WHITE_M = 1e-5
"""Least white noise of cameras: the digits of files."""


class MarkerMemory(NamedTuple):
    """State carried from one frame to the next.

    Attributes:
        noise_scale: Square c of the factor on the noise.
        before_m: (M, 3) markers used in the frame before, if skin is modelled.
        lasting: Mean like c, without its range, of the innovations without the cameras' white noise.
        white: White noise of the cameras, m; None if it is not estimated.
    """

    noise_scale: float
    before_m: Array | None
    lasting: float = 1.0
    white: WhiteNoise | None = None


class MarkerDecision(NamedTuple):
    """Decision on the frame's markers.

    Attributes:
        measured_m: (M, 3) the frame's markers.
        innovation_m: (M, 3) their difference from the predicted ones.
        squared_m2: (M,) its squared length for markers used, 0 for others.
        trusted: (M,) markers used.
        noise_scale: Square of the factor on their noise.
        displaced: Dofs of limbs found elsewhere than predicted.
        before_m: (M, 3) markers used in the frame before; None without a model of skin artefacts.
    """

    measured_m: Array
    innovation_m: Array
    squared_m2: Array
    trusted: BoolArray
    noise_scale: float
    displaced: NDArray[np.intp]
    before_m: Array | None


class Markers(Block[State, MarkerReading, MarkerDecision, MarkerMemory]):
    """Optical markers.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) standard deviation of each.
        settings: Noise and gate.
        expected_m: (M,) expected spread of one reading.
    """

    kind = "markers"

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        dt_s: float,
        unobservable: BoolArray,
        settings: MarkerSettings = MarkerSettings(),
        *,
        spread_m: Array | None = None,
        inflate: bool = True,
        track_loss: bool = True,
        compress: type[MarkerInformation] | type[JacobianInformation] = MarkerInformation,
    ) -> None:
        """Makes the block.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) standard deviation of each marker, m.
            dt_s: Time between frames.
            unobservable: (nv,) dofs that move no marker of the capture.
            settings: Noise and gate.
            spread_m: (M,) spread of one reading of markers with lasting noise, m; None for the one from σ_m and s.
            inflate: True to inflate a displaced limb's predicted covariance.
            track_loss: True to end the track in a frame in which most markers lie far off.
            compress: Arithmetic of the information; both agree up to rounding.
        """
        s = settings
        self.sensor, self.settings, self.noise_m = sensor, s, noise_m * s.marker_noise_scale
        self._inflate, self._track_loss = inflate, track_loss
        expected = self.noise_m * (s.innovation_share or 1.0) ** 0.5
        if spread_m is not None and s.innovation_share > 0.0:
            expected = spread_m * s.marker_noise_scale
        self.expected_m = np.maximum(expected, 1e-9)
        self._certainty = self.expected_m**-2.0
        self._mean_certainty = float(np.mean(self._certainty)) if len(self._certainty) else 0.0
        self._information = compress(sensor, self.noise_m)
        self._skin: SkinMarkers | None = None
        if s.skin_memory_s > 0.0:
            self._skin = SkinMarkers(sensor, self.noise_m, s.camera_noise_m, s.skin_memory_s, dt_s)
        self._observed = ObservedDofs(sensor, unobservable)
        self._forget = 1.0 - exp(-dt_s / s.noise_memory_s)
        self._nv = sensor.model.nv
        self._passes_m2 = s.gate * self.noise_m**2

    def begin(self) -> MarkerMemory:
        """The markers' own noise."""
        white = WhiteNoise(0.0, LEAST_WHITE_M) if self.settings.innovation_share > 0.0 else None
        return MarkerMemory(1.0, None, white=white)

    def prepare(self, state: State, memory: MarkerMemory | None) -> MarkerReading:
        """Predicted markers."""
        return self.sensor.reading(state.q)

    def decide(
        self, at: OperatingPoint[State, MarkerReading], frame: Frame, memory: MarkerMemory, notes: Notes
    ) -> MarkerDecision:
        """Gates the markers and notes the dofs that they leave unobserved."""
        s, predicted = self.settings, at.prepared.positions_m
        found = innovations(frame.markers_m, predicted, s.gate_radius_m)
        innovation = frame.markers_m - predicted if found is None else found.innovation_m
        if found is not None and (found.near or self._close(found, memory.noise_scale)):
            seen, trusted, squared, displaced, lost = found.seen, found.seen, found.squared_m2, None, False
        else:
            P = at.state.P[: self._nv, : self._nv]
            seen, trusted, squared, displaced, lost = gated(
                innovation, at.prepared, P, self.noise_m, s.gate, s.gate_radius_m, memory.noise_scale
            )
        notes.seen, notes.trusted = seen, trusted
        notes.unmarked = notes.unobserved = self._observed.unmarked(trusted)
        notes.observed = trusted.tobytes().count(1) >= s.min_markers
        notes.lost = lost and self._track_loss
        notes.squared_m2 = squared
        if memory.white is not None:
            notes.lasting = max(memory.lasting, 0.0) / memory.noise_scale
        moved = NO_DOFS
        if displaced is not None and self._inflate:
            moved = self._observed.carriers(displaced)
            moved = moved[moved >= 6]
        return MarkerDecision(
            frame.markers_m, innovation, squared, trusted, memory.noise_scale, moved, memory.before_m
        )

    def _close(self, found: Innovations, noise_scale: float) -> bool:
        """True if every marker passes by its noise alone."""
        limit = np.maximum(noise_scale * self._passes_m2, self.settings.gate_radius_m**2)
        np.minimum(limit, TRACK_LOSS_M**2, out=limit)
        return bool((found.squared_m2 <= limit).all())

    def inflate(self, P: Array, decision: MarkerDecision) -> None:
        """Adds to the covariance of a displaced limb's position and velocity."""
        dofs = decision.displaced
        if len(dofs):
            P[dofs, dofs] += DISPLACED_SD_RAD**2
            P[self._nv + dofs, self._nv + dofs] += DISPLACED_SD_RAD_S**2

    def linearise(self, at: OperatingPoint[State, MarkerReading], decision: MarkerDecision) -> Information:
        """Information on the configuration; on (q, v, a) with a model of skin artefacts."""
        state, reading, trusted = at.state, at.prepared, decision.trusted
        innovation = decision.measured_m - reading.positions_m
        if self._skin is None or decision.before_m is None:
            return self._information.at(reading, innovation, trusted, decision.noise_scale)
        q, v, a = state.q, state.v, cast(AcceleratedState, state).a
        found = self._skin.at(q, v, a, reading, innovation, trusted, decision.before_m)
        return found if decision.noise_scale == 1.0 else found.scaled(1.0 / decision.noise_scale)

    def remember(
        self,
        posterior: State,
        at: OperatingPoint[State, MarkerReading],
        decision: MarkerDecision,
        memory: MarkerMemory,
    ) -> MarkerMemory:
        """Running mean of the innovations, and of the cameras' white noise."""
        if self._skin is None and self.settings.innovation_share <= 0.0:
            return memory
        before = None
        if self._skin is not None:
            before = np.where(decision.trusted[:, None], decision.measured_m, np.nan)
        white = None if memory.white is None else memory.white.after(decision.measured_m)
        used = decision.trusted.tobytes().count(1)
        if self.settings.innovation_share <= 0.0 or not used:
            return memory._replace(before_m=before, white=white)
        low, high = self.settings.noise_range
        squared = min(float(decision.squared_m2 @ self._certainty) / (3 * used), high**2)
        scale, lasting = decision.noise_scale, memory.lasting
        scale += self._forget * (max(squared, low**2) - scale)
        not_white = squared - (0.0 if white is None else white.sd**2 * self._mean_certainty)
        lasting += self._forget * (not_white - lasting)
        return MarkerMemory(scale, before, lasting, white)

    def expected_spread(self) -> Array:
        """(M,) of one coordinate of each marker, m."""
        return self.expected_m

    def channels(self, decision: MarkerDecision) -> Channels:
        """Innovations by marker, without those of a displaced limb, which are errors of the state."""
        mean_square, readings = decision.squared_m2 / 3.0, np.where(decision.trusted, 3.0, 0.0)
        if len(decision.displaced):
            carried = self._observed.carried_by(decision.displaced)
            mean_square[carried] = readings[carried] = 0.0
        return Channels(mean_square, readings)

    def log_noise(self, decision: MarkerDecision) -> float:
        """Log det R of the used markers."""
        sd = self.noise_m[decision.trusted] * decision.noise_scale**0.5
        return 6.0 * float(np.log(sd).sum())
