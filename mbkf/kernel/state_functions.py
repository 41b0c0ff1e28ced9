"""Functions of the compiled kernel on a filter's state and its readings (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Annotated as Out
from typing import NamedTuple, Protocol

from mbkf.conventions import Array, Int32Array
from mbkf.kernel.body_functions import Tree
from mbkf.kernel.declaration import requires, unlocked


class Singer(NamedTuple):
    """Steps of position, velocity and acceleration in a Singer plant (:mod:`mbkf.filters.dynamic.plant`)."""

    dt_s: float
    c1: float
    c2: float
    rho: float


class OrientationNoise(NamedTuple):
    """Numbers of an orientation filter, per step: variances, shares, limits (:mod:`mbkf.imu.orientation_ekf`)."""

    dt_s: float
    gravity_m_s2: float
    gyro_noise: float
    gyro_scale_noise: float
    bias_walk: float
    accelerometer_noise: float
    moved: float
    turning: float
    still_variance: float
    memory_squared: float
    most_variance: float
    velocity_samples: float
    heading: float
    heading_samples: float
    field_tolerance: float
    dip_variance: float
    field_memory_s: float
    calm: float
    rest_rate_rad_s: float
    rest_force_m_s2: float
    rest_after_s: float
    rest_variance: float
    resting: bool
    integrating: bool


class StateFunctions(Protocol):
    """Covariances of a state (N components), smoothing, variances and orientations."""

    @requires("3*nv + m <= N")
    @unlocked
    def predict(
        self,
        tree: Tree,
        P: In[Array, "N N symmetric"],
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        singer: Singer,
        noise: In[Array, "3 3"],
        sd: In[Array, "nv"],
        walk: In[Array, "m"],
        /,
    ) -> tuple[
        Made[Array, "P_after: N N"],
        Made[Array, "q_after: nq"],
        Made[Array, "v_after: nv"],
        Made[Array, "a_after: nv"],
    ]:
        """Mean and covariance Φ P Φᵀ + Q of a state (q, v, a, rest) one step later, with Φ_q = [A, B Δt, B c₂, 0].

        Args:
            tree: The body.
            P: Covariance.
            q, v, a: Mean.
            joints: First dof and end of each joint.
            singer: Steps of the plant.
            noise: Covariance of (q, v, a) for σ_a = 1.
            sd: σ_a.
            walk: Variance that the last m states gain, random walks.
        """

    @unlocked
    def propagate_velocities(
        self,
        P: In[Array, "2*nv 2*nv symmetric"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        dt: float,
        noise: In[Array, "2 2 nv"],
        /,
    ) -> Made[Array, "after: 2*nv 2*nv"]:
        """Φ P Φᵀ + Q of a state (q, v) with Φ_q = [A, B Δt] and velocities that stay.

        Args:
            P: Covariance.
            A, B: Derivatives of the next configuration by this one and by the step; zero between joints.
            joints: First dof and end of each joint.
            dt: Δt, s.
            noise: Diagonals of the blocks of Q.
        """

    @requires("n <= N")
    @unlocked
    def add_information(
        self,
        P: In[Array, "N N symmetric"],
        information: In[Array, "n n symmetric"],
        rows: In[Array, "m N"],
        after: Out[Array, "N N symmetric"],
        /,
    ) -> int:
        """Writes (P⁻¹ + Λ)⁻¹; returns 0, or the number of the factorisation that failed.

        Args:
            P: Prior covariance.
            information: Part of Λ on the first n components.
            rows: Whitened Jacobian H of further readings, which add HᵀH to Λ.
            after: Posterior covariance.
        """

    @requires("n <= N")
    def correction(
        self,
        P: In[Array, "N N symmetric"],
        vector: In[Array, "n"],
        rows: In[Array, "m N"],
        values: In[Array, "m"],
        /,
    ) -> Made[Array, "step: N"]:
        """P (λ + Hᵀy).

        Args:
            P: Posterior covariance.
            vector: λ on the first n components.
            rows: Whitened Jacobian H.
            values: Innovations y.
        """

    @requires("3*nv+12 <= N", "nv <= n", "n <= N", "nv <= p", "p <= N", "s <= nv")
    @unlocked
    def error_variances(
        self,
        P: In[Array, "N N symmetric"],
        information: In[Array, "nv nv symmetric"],
        seen: In[Int32Array, "s in 0:nv"],
        size: In[Array, "N"],
        skin: float,
        rate: float,
        sharing: float,
        rows: In[Array, "k N"],
        T: In[Array, "m n fortran"],
        U: In[Array, "l p fortran"],
        first: In[Int32Array, "b in 0:nv-2"],
        /,
    ) -> tuple[
        int,
        Made[Array, "diagonal: N"],
        Made[Array, "of_T: m"],
        Made[Array, "of_U: l"],
        Made[Array, "blocks: b 3 3"],
    ]:
        """Diagonals of an error covariance Σ, of T Σ Tᵀ and of U Σ Uᵀ, and blocks of Σ; before them 0, or 1 in failure.

        Σ is that of :mod:`mbkf.filters.error_covariance`. It fails where the information has no Cholesky factor.

        Args:
            P: Covariance.
            information: Information of one frame's markers.
            seen: Dofs that the markers observe, ascending.
            size: Factors on errors of P's kind.
            skin, rate: Variance of skin and its rate, rad/s.
            sharing: Multiple of P's covariance of half the difference of both feet's wrenches that is added to each of
                them, and taken from between them.
            rows: Roots of the part that is added.
            T, U: Quantities of the first n, the first p components.
            first: First of three components of each block.
        """

    @requires("root >= 0", "root + 4 <= nq")
    def coordinate_deviations(
        self,
        q: In[Array, "nq"],
        quaternions: In[Int32Array, "n in 0:nq-3"],
        axes: In[Int32Array, "n 3 in 0:3"],
        signs: In[Array, "n 4"],
        root: int,
        root_axes: In[Array, "3 3"],
        dofs: In[Int32Array, "n+1 3 in 0:nv"],
        columns: In[Int32Array, "n+1 3 in 0:A"],
        single_dofs: In[Int32Array, "k in 0:nv"],
        single_columns: In[Int32Array, "k in 0:A"],
        zero: In[Array, "A"],
        position: In[Array, "nv"],
        velocity: In[Array, "nv"],
        blocks: In[Array, "n+1 3 3"],
        offset: In[Array, "nv"] | None,
        rate_offset: In[Array, "nv"] | None,
        offset_blocks: In[Array, "n+1 3 3"] | None,
        rate_offset_blocks: In[Array, "n+1 3 3"] | None,
        /,
    ) -> Made[Array, "deviations: 4 A"]:
        """Standard deviations of clinical coordinates and their rates, and the offset's part of both.

        Args:
            q: Configuration.
            quaternions: First component in q of the quaternion of each joint with three angles.
            axes: Axes of each joint's angles.
            signs: Parity of the axes and signs of the angles.
            root: First component of the root's quaternion in q.
            root_axes: Rotation from world axes to the axes of the root's position.
            dofs, columns: Dofs and coordinates of each joint, and last of the root's position.
            single_dofs, single_columns: Of the other coordinates, each ± one dof.
            zero: Variances of the coordinates' zeros, which add to the offset.
            position, velocity: Variances of the dofs.
            blocks: Covariances of the joints' dofs.
            offset, rate_offset: Variances of the offset; None without.
            offset_blocks, rate_offset_blocks: Its covariances of the joints' dofs.
        """

    @requires("T >= 1")
    @unlocked
    def orientation_course(
        self,
        noise: OrientationNoise,
        quaternion: In[Array, "N 4"],
        gyro_bias: In[Array, "N 3"],
        velocity: In[Array, "N 3"],
        P: In[Array, "N 9 9"],
        movement: In[Array, "N"],
        field: In[Array, "N 3"],
        calm: In[Array, "N 7"],
        last: In[Array, "N 6"],
        gyro: In[Array, "T N 3"],
        specific_force: In[Array, "T N 3"],
        magnetic_field: In[Array, "T N 3"] | None,
        smooth: bool,
        /,
    ) -> tuple[
        bool,
        Made[Array, "quaternions: T N 4"],
        Made[Array, "biases: T N 3"],
        Made[Array, "variances: T N 9"],
    ]:
        """Courses of N sensors over T samples; False where a covariance is not positive.

        Args:
            noise: Numbers of the filter.
            quaternion, gyro_bias, velocity, P, movement, field, calm, last: State at the first sample, as
                :class:`mbkf.imu.orientation_ekf.OrientationState`.
            gyro: rad/s, NaN where missing.
            specific_force: m/s², NaN where missing.
            magnetic_field: µT, NaN where missing; None without magnetometers.
            smooth: Later samples correct earlier ones.
        """

    @requires("T >= 1")
    @unlocked
    def madgwick_course(
        self,
        quaternion: In[Array, "N 4"],
        gyro: In[Array, "T N 3"],
        specific_force: In[Array, "T N 3"],
        magnetic_field: In[Array, "T N 3"] | None,
        dt_s: float,
        beta: float,
        zeta: float,
        /,
    ) -> tuple[Made[Array, "quaternions: T N 4"], Made[Array, "biases: T N 3"]]:
        """Courses of N sensors over T samples by Madgwick's filter (:mod:`mbkf.imu.madgwick`).

        Args:
            quaternion: At the first sample, (x, y, z, w).
            gyro: rad/s, NaN where missing.
            specific_force: Any unit, NaN where missing.
            magnetic_field: Any unit, NaN where missing; None without magnetometers.
            dt_s: Time between samples.
            beta, zeta: Gains.
        """

    def mean_activity(
        self,
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        before: In[Array, "nv"] | None,
        rate: float,
        share: float,
        /,
    ) -> Made[Array, "after: nv"]:
        """Running mean of a² + (rate v)², to which a frame adds a share; the frame's own where there is not one before.

        Args:
            v, a: Velocity and acceleration.
            before: The mean before.
            rate: 1/s.
            share: Weight of the frame.
        """

    def is_possible(
        self,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        wrenches: In[Array, "k 6"],
        rate: float,
        force: float,
        /,
    ) -> bool:
        """True where q, v and a are finite, and neither a velocity nor a force along an axis exceeds its bound.

        Args:
            q, v, a: Motion.
            wrenches: Force and moment; NaN where not known.
            rate: Greatest velocity.
            force: Greatest force, N.
        """

    def third_differences(
        self,
        first: In[Array, "*count"],
        second: In[Array, "*count"],
        third: In[Array, "*count"],
        latest: In[Array, "*count"],
        level: float,
        /,
    ) -> tuple[Made[int, "known"], Made[int, "below"]]:
        """Number of third differences that are numbers, and of those below a level.

        Args:
            first, second, third, latest: Samples; NaN without a reading.
            level: The level.
        """

    @requires("readings >= 0", "readings <= k", "first >= 0", "channels >= 1", "first + channels <= n")
    def square_channels(
        self,
        whitened: In[Array, "k"],
        readings: int,
        first: int,
        channels: int,
        mean_square: Out[Array, "n"],
        counted: Out[Array, "n"],
        /,
    ) -> None:
        """Writes mean squares and numbers of whitened readings, which alternate in threes between channels.

        Args:
            whitened: Innovations.
            readings: Number of those that count, the first ones.
            first, channels: First of the channels, and their number.
            mean_square, counted: Of all channels; others are left as they are.
        """

    def judge_innovations(
        self,
        kinds: int,
        mean_square: In[Array, "n"],
        readings: In[Array, "n"],
        before: In[Array, "n"],
        frames: In[Array, "n"],
        least: In[Array, "n"],
        most: In[Array, "n"],
        kind: In[Int32Array, "n in 0:kinds"],
        forget: float,
        /,
    ) -> tuple[
        Made[Array, "squared: kinds"],
        Made[Array, "counted: kinds"],
        Made[Array, "ratio: n"],
        Made[Array, "variance: n"],
        Made[Array, "after: n"],
        Made[Array, "frames_after: n"],
    ]:
        """A frame's innovations in units of their running spread, summed by kind, and the spread after them.

        Args:
            kinds: Number of kinds.
            mean_square: Mean squares of the frame's readings by channel; any number where there is not a reading.
            readings: Their number.
            before, frames: Running mean squares of the channels and the frames that each rests on.
            least, most: Range in which variances lie.
            kind: Kind of each channel.
            forget: Least weight of a frame.
        """

    def choose_products(self, own: bool, /) -> None:
        """Multiplies matrices by 512-bit instructions of the kernel's own where the processor has them, or by BLAS."""

    def vector_bits(self) -> int:
        """Bits of the vectors that multiply matrices; 0 where BLAS does."""
