"""Plant of the dynamic filter: decaying accelerations (Singer 1970) and foot wrenches that are random walks.

Each dof's acceleration is a first-order Gauss–Markov process with a stationary standard deviation σ_a and time T, whose
jerk is constant within a frame:

    a' = ρ a + n,  v' = v + (a + a') Δt/2,  q' = q ⊕ (v Δt + (2 a + a') Δt²/6),  w' = w,  ρ = e^(−Δt/T)

that is v' = v + a c₁ + n Δt/2 and q' = q ⊕ (v Δt + a c₂ + n Δt²/6) with c₁ = Δt (1 + ρ)/2, c₂ = Δt² (2 + ρ)/6 and
n ~ N(0, (1 − ρ²) σ_a²). One noise moves all three: positions, velocities and accelerations are one trajectory. Jerk
that is white within the frame, Singer's own, lets v leave the integral of a by 0.2 σ_a Δt in every frame, so that an
acceleration that Newton's law demands departs from the motion that the markers show.

σ_a follows the motion: a joint at rest is expected to stay so, a busy one to change quickly. The process noise of the
wrenches depends on the contact of the feet and is the contact block's (:mod:`mbkf.sensors.foot_contact`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import expm

from mbkf.conventions import Array, BoolArray
from mbkf.filters.plant import DofNoise, Plant
from mbkf.kernel.covariance import joint_ranges
from mbkf.kernel.loading import library
from mbkf.kernel.state_functions import Singer
from mbkf.model.body import Body
from mbkf.model.layout import Layout
from mbkf.numerics.transition import RateTransition
from mbkf.sensors.block import Notes


@dataclass(frozen=True)
class SingerSettings:
    """Process noise of the dynamic filter.

    Attributes:
        acceleration_scale: Factor on the body's table of movement accelerations (``movement_sd``).
        quiet_share: σ_a of a joint that rests, as a share of the table.
        activity_gain, activity_rate: σ_a of one that moves is this times the root mean square of its recent
            acceleration and of its velocity times the rate (1/s); gain 0 keeps the table.
        activity_memory_s: Time over which that mean is taken.
        busy_shares: σ_a is at most this many times the table, for the pelvis's translation and for all else.
        decay_s: Time T in which an unobserved acceleration fades.
        constant_jerk: True for one trajectory; False for jerk that is white within the frame, Singer's own, where
            inertial sensors alone show the body: they read velocities and accelerations, each with errors that last.
    """

    acceleration_scale: float = 1.0
    quiet_share: float = 0.1
    activity_gain: float = field(default=6.0, metadata={"zero": True})
    activity_rate: float = 5.0
    activity_memory_s: float = 0.05
    busy_shares: tuple[float, float] = (2.0, 8.0)
    decay_s: float = 0.06
    constant_jerk: bool = True


@dataclass(frozen=True)
class DynamicState:
    """Mean and covariance of positions, velocities, accelerations and foot wrenches.

    Attributes:
        q: (nq,) configuration.
        v, a: (nv,) velocity and acceleration in the joints' own axes: rad/s, m/s, rad/s², m/s².
        w: (12,) wrench of the ground on right and left foot: force N, moment N m about the world's origin, world axes.
        P: (N, N) covariance of (q, v, a, w, extra) in the tangent space.
        extra: (m,) states that blocks add.
    """

    q: Array
    v: Array
    a: Array
    w: Array
    P: Array
    extra: Array = field(default_factory=lambda: np.zeros(0))

    def retracted(self, model: Body, step: Array, P: Array) -> DynamicState:
        """The state moved by a tangent vector.

        Args:
            model: The body.
            step: (N,) tangent vector.
            P: (N, N) covariance of the moved state.
        """
        if (tree := model.tree) is not None:
            q, v, a, wrench, own = tree.moved(self.q, self.v, self.a, self.w, self.extra, step)
            return DynamicState(q, v, a, wrench, P, own)
        nv = len(self.v)
        w, extra = 3 * nv, 3 * nv + len(self.w)
        return DynamicState(
            model.integrate(self.q, step[:nv]),
            self.v + step[nv : 2 * nv],
            self.a + step[2 * nv : w],
            self.w + step[w:extra],
            P,
            self.extra + step[extra:],
        )

    def minus(self, model: Body, origin: DynamicState) -> Array:
        """(N,) tangent vector from the mean of another state to this one's."""
        q = model.difference(origin.q, self.q)
        rest = (self.v - origin.v, self.a - origin.a, self.w - origin.w, self.extra - origin.extra)
        return np.concatenate([q, *rest])


class SingerPlant(Plant[DynamicState, Array, Array | None]):
    """Predicts a :class:`DynamicState`, in compiled code where there is such.

    Attributes:
        model: The body.
        layout: Slices of the tangent state.
        dt_s: Time step Δt.
        acceleration_sd: (nv,) the table's σ_a; 0 holds a dof where it is.
        settings: Adaptation of σ_a, and T.
        rho, c1, c2: The factors above.
        covariance: (3, 3) covariance of (q, v, a) after one step for σ_a = 1.
    """

    def __init__(
        self,
        model: Body,
        layout: Layout,
        dt_s: float,
        held: BoolArray,
        settings: SingerSettings = SingerSettings(),
    ) -> None:
        """Makes the plant.

        Args:
            model: The body.
            layout: Slices of the tangent state (:meth:`mbkf.model.layout.Layout.dynamic`).
            dt_s: Time step.
            held: (nv,) dofs that no instrument shows; they stay where they are.
            settings: Process noise.
        """
        super().__init__(model, layout, dt_s)
        s, self.settings = settings, settings
        self.acceleration_sd = np.where(held, 0.0, s.acceleration_scale * model.movement_sd)
        self.rho = float(np.exp(-dt_s / s.decay_s))
        if s.constant_jerk:
            self.c1, self.c2 = dt_s * (1.0 + self.rho) / 2.0, dt_s**2 * (2.0 + self.rho) / 6.0
            per_noise = np.array([dt_s**2 / 6.0, dt_s / 2.0, 1.0])
            self.covariance = (1.0 - self.rho**2) * np.outer(per_noise, per_noise)
        else:
            self.c1 = -s.decay_s * float(np.expm1(-dt_s / s.decay_s))
            self.c2 = s.decay_s * (dt_s - self.c1)
            self.covariance = _white_jerk(dt_s, s.decay_s)
        self._calm = 1.0 - float(np.exp(-dt_s / s.activity_memory_s))
        self._quiet = (s.quiet_share * self.acceleration_sd) ** 2
        self._gain = s.activity_gain**2
        self._busiest = self.acceleration_sd * np.where(np.arange(model.nv) < 3, *s.busy_shares)
        self._joints = joint_ranges(joint.v for joint in model.joints.values())
        self._push, self._rates = np.array([dt_s, self.c2]), np.array([[1.0, self.c1], [0.0, self.rho]])
        singer = Singer(dt_s, self.c1, self.c2, self.rho)
        self._kernel, self._constants = library(), (self._joints, singer, self.covariance)

    def noise(self, memory: Array | None) -> Array:
        """(nv,) σ_a of the next step."""
        if memory is None:
            return self.acceleration_sd
        busy = np.sqrt(self._quiet + self._gain * memory)
        return np.minimum(busy, self._busiest)

    def remember(self, posterior: DynamicState, notes: Notes, memory: Array | None) -> Array | None:
        """(nv,) mean square of recent accelerations, m²/s⁴ or rad²/s⁴.

        Dofs that nothing observes move as the table says: a mean of their own estimates would feed on itself.
        """
        s, unobserved = self.settings, notes.unobserved
        if s.activity_gain <= 0.0:
            return None
        if self._kernel is not None and not len(unobserved):
            return self._kernel.mean_activity(posterior.v, posterior.a, memory, s.activity_rate, self._calm)
        now: Array = posterior.a**2 + (s.activity_rate * posterior.v) ** 2
        if len(unobserved):
            now[unobserved] = (self.acceleration_sd[unobserved] / s.activity_gain) ** 2
        return now if memory is None else memory + self._calm * (now - memory)

    def move(self, state: DynamicState) -> DynamicState:
        """The state one step later: q ⊕ (v Δt + a c₂), v + a c₁, ρ a."""
        q = self.model.integrate(state.q, self.dt_s * state.v + self.c2 * state.a)
        return replace(state, q=q, v=state.v + self.c1 * state.a, a=self.rho * state.a)

    def transition(self, state: DynamicState) -> Array:
        """(N, N) Φ at a state."""
        return self._parts(state).matrix(self.layout.size)

    def step_transition(self, before: DynamicState, predicted: DynamicState) -> RateTransition:
        """Φ of a step, by its parts."""
        return self._parts(before)

    def _parts(self, state: DynamicState) -> RateTransition:
        A, B = self.model.integration_derivatives(state.q, self.dt_s * state.v + self.c2 * state.a)
        return RateTransition(A, B, self._joints, self._push, self._rates)

    def predict(self, state: DynamicState, noise: Array | None = None) -> DynamicState:
        """The state one step later; its P = Φ P Φᵀ + Q is exactly symmetric, new, and in Fortran order.

        Args:
            state: The state.
            noise: (nv,) σ_a for this step; None for the table's.
        """
        sd = self.acceleration_sd if noise is None else noise
        if self._kernel is None or (tree := self.model.tree) is None:
            return super().predict(state, self.process_noise(sd))
        motion = state.P, state.q, state.v, state.a
        P, q, v, a = self._kernel.predict(tree.handle, *motion, *self._constants, sd, self._walk)
        return DynamicState(q, v, a, state.w, P.T, state.extra)

    def dof_noise(self, noise: Array | None) -> DofNoise | None:
        """σ_a moves position, velocity and acceleration of a dof alike, where its jerk is constant within a frame."""
        if not self.settings.constant_jerk:
            return None
        return DofNoise(np.sqrt(self.covariance.diagonal()), self.acceleration_sd if noise is None else noise)

    def process_noise(self, sd: Array) -> Array:
        """(N, N) Q of one step for accelerations of standard deviations (nv,)."""
        Q, moving = np.zeros((self.layout.size, self.layout.size)), slice(self.layout.a.stop)
        Q[moving, moving] = np.kron(self.covariance, np.diag(sd * sd))
        return Q


def _white_jerk(dt_s: float, decay_s: float) -> Array:
    """(3, 3) ∫ e^(Fs) G Gᵀ e^(Fᵀs) ds over Δt for unit stationary variance (Van Loan 1978)."""
    F = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / decay_s]])
    blocks = np.zeros((6, 6))
    blocks[:3, :3], blocks[3:, 3:] = -F, F.T
    blocks[2, 5] = 2.0 / decay_s
    exponential = expm(blocks * dt_s)
    noise = exponential[3:, 3:].T @ exponential[:3, 3:]
    return 0.5 * (noise + noise.T)
