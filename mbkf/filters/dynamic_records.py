"""What the dynamic filter hands from step to step: its memory, what it decided, its readings, and the result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.filters.singer import DynamicState
from mbkf.filters.synergy import Synergy
from mbkf.numerics.kalman import Information, correct
from mbkf.sensors.contact.records import ContactDecision, ContactMemory
from mbkf.sensors.planted import Planted


class ShownFrame(NamedTuple):
    """A frame that was noted: its block of time, features (p,), posture and velocity (2 nv,), and dofs seen (nv,)."""

    block: int
    features: Array
    movement: Array
    seen: BoolArray


class Shown(NamedTuple):
    """What a trial has shown so far, for joints that will be out of sight (:mod:`mbkf.filters.habit`).

    Attributes:
        frame: How many frames have passed.
        noted: Some of the last ones.
        gone: Numbers of the joints that are out of sight now.
        synergies: What was learned of them, by their number.
    """

    frame: int
    noted: tuple[ShownFrame, ...]
    gone: tuple[int, ...]
    synergies: Mapping[int, Synergy]


class Expected(NamedTuple):
    """What joints out of sight are expected to do.

    Attributes:
        dofs: (n,) theirs.
        q: (nq,) a configuration with their posture.
        v: (n,) their velocities.
        q_sd, v_sd: (n,) spreads of both, per reading.
    """

    dofs: NDArray[np.intp]
    q: Array
    v: Array
    q_sd: Array
    v_sd: Array


class Memory(NamedTuple):
    """What a frame leaves for the next besides its estimate.

    Attributes:
        footing: Of the contact decision.
        noise_scale: Square of the factor on the markers' noise.
        activity: (nv,) mean square of recent accelerations, m²/s⁴ or rad²/s⁴; None before the first frame.
        markers_m: (M, 3) markers believed, NaN elsewhere; None where skin artefacts are not modelled.
        usual: (nq,) mean posture; None where there are no inertial sensors.
        shown: What was seen of the joints; None where habits are not asked for.
    """

    footing: ContactMemory
    noise_scale: float
    activity: Array | None
    markers_m: Array | None
    usual: Array | None = None
    shown: Shown | None = None


class Decision(NamedTuple):
    """What a frame's readings were taken to be; with it the same readings can be linearised elsewhere.

    Attributes:
        trusted: (M,) markers believed.
        seen: (M,) markers seen.
        load: What the feet stand on.
        noise_scale: Square of the factor on the markers' noise.
        unseen: Dofs of joints whose segment shows no marker.
        planted: Loaded feet none of whose markers is seen.
        displaced: Dofs of limbs that came back into sight where nobody expected them.
        acceleration_sd: (nv,) σ_a with which the frame was predicted.
        before_m: (M, 3) markers believed in the frame before; None where skin artefacts are not modelled.
        strayed: Whether most markers lie far from the state.
        imus: (S, 6) inertial readings; None where there are none. Then ``unseen`` leaves out what they feel.
        usual: (nq,) mean posture so far, for joints that nothing shows; None where there are no inertial sensors.
        unmarked: Dofs of joints whose segment shows no marker, felt or not, where there are inertial readings.
        lifted: Free feet, 0 right and 1 left, that would end up pulling at the floor and so carry nothing.
        expected: What joints out of sight are expected to do; None where nothing was learned of them.
    """

    trusted: BoolArray
    seen: BoolArray
    load: ContactDecision
    noise_scale: float
    unseen: NDArray[np.intp]
    planted: tuple[Planted, ...]
    displaced: NDArray[np.intp]
    acceleration_sd: Array
    before_m: Array | None
    strayed: bool
    imus: Array | None = None
    usual: Array | None = None
    unmarked: NDArray[np.intp] | None = None
    lifted: tuple[int, ...] = ()
    expected: Expected | None = None


@dataclass(frozen=True)
class FrameReadings:
    """A frame's readings linearised at a state: information on q, and whitened rows on the whole state.

    Attributes:
        markers: Information of the markers alone.
        matrix: (nv, nv) information on the configuration, pulls and limits included.
        vector: (nv,) its vector.
        rows: (k, N) rows R^(-1/2) H of the other readings.
        values: (k,) their innovations R^(-1/2) y.
        readings: Number of scalar readings of instruments and of Newton's law among the rows (the last ones are pulls).
    """

    markers: Information
    matrix: Array
    vector: Array
    rows: Array
    values: Array
    readings: int

    @property
    def whole_matrix(self) -> Array:
        """(N, N) Hᵀ R⁻¹ H of all readings."""
        total = self.rows.T @ self.rows
        n = len(self.vector)
        total[:n, :n] += self.matrix
        return total

    def apply(self, vector: Array) -> Array:
        """(N,) Hᵀ R⁻¹ H times a vector (N,)."""
        total = (self.rows @ vector) @ self.rows
        n = len(self.vector)
        total[:n] += self.matrix @ vector[:n]
        return total

    @property
    def whole_vector(self) -> Array:
        """(N,) Hᵀ R⁻¹ y of all readings."""
        total = self.values @ self.rows
        total[: len(self.vector)] += self.vector
        return total


@dataclass(frozen=True)
class DynamicStep:
    """One step of the filter; what only the next step or a report needs is worked out when asked for.

    Attributes:
        state: Posterior.
        remember: Makes the memory for the next step.
        decision: What the frame's readings were taken to be.
        tracked: Whether enough markers were believed, and the state was not far from most of them.
        predicted: Prior of this frame.
        frame: Readings linearised at the prior.
    """

    state: DynamicState
    remember: Callable[[], Memory]
    decision: Decision
    tracked: bool
    predicted: DynamicState
    frame: FrameReadings

    @cached_property
    def memory(self) -> Memory:
        """For the next step."""
        return self.remember()

    @property
    def refused(self) -> BoolArray:
        """(M,) markers seen but not believed."""
        return self.decision.seen & ~self.decision.trusted

    @property
    def readings(self) -> int:
        """Number of readings in :attr:`nis`."""
        return self.frame.markers.readings + self.frame.readings

    @cached_property
    def nis(self) -> float:
        """Normalised innovation squared of markers, plates and Newton's law; pulls and limits are no readings."""
        frame = self.frame
        rows, values = frame.rows[: frame.readings], frame.values[: frame.readings]
        after = correct(self.predicted.P, frame.markers)
        innovation = values - rows @ after.step
        S = rows @ after.covariance @ rows.T + np.eye(len(rows))
        return after.nis + float(innovation @ np.linalg.solve(S, innovation))
