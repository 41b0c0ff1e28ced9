"""A tracker for a loop of one's own: readings in frame by frame, estimates with standard deviations out.

It takes the very steps that ``reconstruct`` and ``mbkf live`` take. A start looks a quarter of a second ahead, so the
first frames are answered together when it has succeeded.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import ShapeError
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.estimate import Posterior
from mbkf.filters.inverse_dynamics import support_torques
from mbkf.filters.plant import PlantMaker
from mbkf.filters.record import HeldErrors
from mbkf.filters.spread import Spread
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.io.records import PlateReadings
from mbkf.io.subject import Subject
from mbkf.model.clinical import dof_names
from mbkf.model.newton_euler import NewtonEuler
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.block import NO_READINGS, AnyBlock, Frame
from mbkf.sensors.contact.possible import without_impossible
from mbkf.trial.live.filter import LiveFilter, LiveInputs, live_inputs, live_settings
from mbkf.trial.preparation.filters import standard, tracking_filter
from mbkf.trial.preparation.other_contacts import contact_opener
from mbkf.trial.preparation.settings import ReconstructSettings


@dataclass(frozen=True)
class Estimate:
    """A frame's estimate; what is not asked for is not computed.

    Standard deviations (``…_sd``) are totals. ``…_sd_offset`` is the part that repeats whenever the posture is the
    same, because the body is not known exactly; the rest, √(sd² − offset²), is the filter's. A single frame knows no
    mean over the trial, so that the change of the offset with the posture is in the offset alone.

    Attributes:
        number: Number of the frame, counted from 0 at the first one pushed.
        q: (nq,) configuration (:class:`mbkf.HumanModel`).
        v, a: (nv,) velocity and acceleration in the tangent space.
        wrenches: (2, 6) of the ground on right and left foot: force N, moment N m about the world's origin; NaN where
            the filter estimates none.
        tracked: Whether enough instruments read to follow the body.
        nis: Normalised innovation squared of the frame per reading; about 1 where readings err as they did before, NaN
            at a start.
        posterior: The filter's own record.
    """

    number: int
    q: Array
    v: Array
    a: Array
    wrenches: Array
    tracked: bool
    posterior: Posterior
    _filter: TrackingFilter
    _balance: NewtonEuler
    _by_body: Callable[[], BodyErrorRoots | None]

    @property
    def nis(self) -> float:
        """Normalised innovation squared per reading; NaN at a start."""
        found = self._filter.innovations(self.posterior)
        readings = 0 if found is None else int(found.readings.sum())
        return np.nan if found is None or not readings else float(found.squared.sum()) / readings

    @cached_property
    def wrenches_sd(self) -> Array:
        """(2, 6) standard deviations of the wrenches."""
        return np.hypot(self._filter.wrench_sd(self.posterior), self.wrenches_sd_offset)

    @property
    def wrenches_sd_offset(self) -> Array:
        """(2, 6) the offset's part of them."""
        return self._spread.wrench_offset

    @cached_property
    def tau(self) -> Array:
        """(nv,) generalised forces, N and N m; the first six are the residual at the root."""
        wrenches = np.nan_to_num(self.wrenches)
        tau = self._balance.tau(self.q, self.v, self.a, wrenches.ravel())
        return tau - support_torques(self._filter.model, self.q, self.support) if self.support.any() else tau

    @cached_property
    def support(self) -> Array:
        """(B, 6) wrenches on parts besides the feet, as ``wrenches``, in the order of ``support_names``."""
        parts = len(self._filter.model.description.bearings)
        known = self.posterior.support
        return np.zeros((parts, 6)) if known is None else known

    @property
    def support_sd(self) -> Array:
        """(B, 6) their standard deviations, the filter's part; NaN before a contact has opened."""
        return self._filter.support_sd(self.posterior)

    @property
    def support_names(self) -> tuple[str, ...]:
        """(B,) parts besides the feet that may bear load."""
        return tuple(self._filter.model.description.bearings)

    @cached_property
    def tau_sd(self) -> Array:
        """(nv,) their standard deviations, NaN where not known."""
        return self._spread.torque

    @property
    def tau_sd_offset(self) -> Array:
        """(nv,) the offset's part of them."""
        return self._spread.torque_offset

    @cached_property
    def q_sd(self) -> Array:
        """(nv,) standard deviations of the configuration in its tangent space."""
        return self._spread.position

    @property
    def q_sd_offset(self) -> Array:
        """(nv,) the offset's part of them."""
        return self._spread.position_offset

    @cached_property
    def v_sd(self) -> Array:
        """(nv,) standard deviations of the velocity."""
        return self._spread.velocity

    @property
    def v_sd_offset(self) -> Array:
        """(nv,) the offset's part of them."""
        return self._spread.velocity_offset

    @property
    def angles(self) -> dict[str, float]:
        """Clinical coordinates by name: rad, of the root's translations m."""
        return dict(zip(self._names, self._angles[0].tolist(), strict=True))

    @property
    def angles_sd(self) -> dict[str, float]:
        """Their standard deviations."""
        return dict(zip(self._names, self._spread.angle.tolist(), strict=True))

    @property
    def angles_sd_offset(self) -> dict[str, float]:
        """The offset's part of them."""
        return dict(zip(self._names, self._spread.angle_offset.tolist(), strict=True))

    @property
    def rates(self) -> dict[str, float]:
        """Rates of the clinical coordinates, rad/s and m/s."""
        rates = self._filter.clinical.rate_matrices(self.q[None], self._angles)[0] @ self.v
        return dict(zip(self._names, rates.tolist(), strict=True))

    @property
    def torques(self) -> dict[str, float]:
        """Moments conjugate to the clinical coordinates by name, N m (N for translations)."""
        found = self._filter.clinical.moments(self.q[None], self.tau[None], self._angles)
        return dict(zip(self._names, found[0].tolist(), strict=True))

    @property
    def torques_sd(self) -> dict[str, float]:
        """Their standard deviations."""
        return self._moments_sd(self.tau_sd)

    @property
    def torques_sd_offset(self) -> dict[str, float]:
        """The offset's part of them."""
        return self._moments_sd(self.tau_sd_offset)

    @property
    def dofs(self) -> tuple[str, ...]:
        """(nv,) names of the tangent dofs."""
        return dof_names(self._filter.model)

    def _moments_sd(self, tau_sd: Array) -> dict[str, float]:
        found = self._filter.clinical.moments_sd(self.q[None], tau_sd[None], self._angles)
        return dict(zip(self._names, found[0].tolist(), strict=True))

    @cached_property
    def _angles(self) -> Array:
        return self._filter.clinical.angles(self.q[None])

    @cached_property
    def _spread(self) -> Spread:
        return self._filter.spread(self.posterior, body=self._by_body())

    @property
    def _names(self) -> tuple[str, ...]:
        return self._filter.clinical.names


class Tracker:
    """Follows a person frame by frame.

    Attributes:
        names: (M,) markers it follows, in the order of the arrays pushed.
        answers: Estimates that the last push gave: one, or several after a start.
    """

    def __init__(
        self,
        subject: Subject,
        markers: Sequence[str] | None = None,
        plates: Sequence[PlateReadings] = (),
        rate_hz: float = 100.0,
        *,
        settings: ReconstructSettings | None = None,
        blocks: Sequence[AnyBlock] | None = None,
        plant: PlantMaker | None = None,
    ) -> None:
        """Makes a tracker that has seen nothing yet.

        Args:
            subject: The scaled person (:func:`mbkf.scale`, :func:`mbkf.read_subject`).
            markers: (M,) names of the markers in the order in which they will be pushed; None for the subject's own.
                Names that the subject does not know are left out.
            plates: The force plates; only their places and thresholds are used (``capture.plates`` will do).
            rate_hz: Frame rate.
            settings: Filter and its settings. It answers causally, or with their lag, since later frames are not known.
            blocks: Blocks of the dynamic filter, :func:`standard_blocks` and one's own; None for the standard ones.
            plant: Makes the plant of the dynamic filter (:class:`mbkf.Plant`); None for the standard one.

        Raises:
            NotObservable: Too few of the subject's markers are among the markers.
            InvalidInput: Blocks or a plant are given for another filter than the dynamic one, or smoothing is set.
        """
        settings = live_settings(settings or ReconstructSettings())
        live = _inputs(subject, markers, plates, rate_hz, settings)
        self._given = len(_marker_names(subject, markers))
        self.names, self._columns, self._plates = live.names, live.columns, tuple(plates)
        self._weight_n = GRAVITY_M_S2 * subject.mass_kg
        with single_threaded():
            self._filter = tracking_filter(settings.filter, live.inputs, blocks, plant)
        opener = contact_opener(live.inputs, settings) if blocks is None else None
        self._live = LiveFilter(self._filter, settings.lag_s, opener)
        self._balance = NewtonEuler(self._filter.model)
        self._body = HeldErrors(live.inputs.body, self._filter.dt_s)
        self._number = 0
        self.answers: list[Estimate] = []

    def push(
        self,
        markers_m: Array,
        wrenches: Array | None = None,
        *,
        imus: Array | None = None,
        readings: Mapping[str, Array] = NO_READINGS,
    ) -> Estimate | None:
        """The estimate of the next frame; with a lag (``settings.lag_s``), of the one so many frames before it.

        Args:
            markers_m: (M, 3) marker positions in the world, m, z up; NaN where missing.
            wrenches: (K, 6) force N and moment N m about the world's origin of every plate; NaN or None where not
                recorded. What this person cannot make a plate read is taken for not recorded.
            imus: (S, 6) readings of inertial sensors that blocks know: angular velocity rad/s, specific force m/s².
            readings: Of instruments of one's own, by the name that their block knows.

        Returns:
            None while a start looks ahead or the lag is not over, and as long as no start succeeds.

        Raises:
            ShapeError: The arrays do not belong to this tracker's markers or plates.
        """
        markers_m = np.asarray(markers_m, dtype=float)
        if markers_m.shape != (self._given, 3):
            raise ShapeError("markers_m", f"({self._given}, 3)", markers_m.shape)
        count = len(self._plates)
        plates = np.full((count, 6), np.nan) if wrenches is None else np.asarray(wrenches, dtype=float)
        if plates.shape != (count, 6):
            raise ShapeError("wrenches", f"({count}, 6)", plates.shape)
        plates = without_impossible(plates, self._plates, self._weight_n)
        frame = Frame(markers_m[self._columns], plates, imus, readings)
        with single_threaded():
            steps = self._live.push(self._number, frame)
        self._number += 1
        self.answers = [self._estimate(s.number, s.estimate) for s in steps if s.estimate is not None]
        latest = self.answers[-1] if self.answers else None
        due = self._number - 1 - self._live.lag_frames
        return latest if latest is not None and latest.number == due else None

    def finish(self) -> list[Estimate]:
        """Estimates of frames that still wait for a start or their lag, when no more follow."""
        with single_threaded():
            steps = self._live.finish()
        return [self._estimate(s.number, s.estimate) for s in steps if s.estimate is not None]

    def _estimate(self, number: int, posterior: Posterior) -> Estimate:
        return Estimate(
            number,
            posterior.q,
            posterior.v,
            posterior.a,
            posterior.wrench,
            posterior.tracked,
            posterior,
            self._filter,
            self._balance,
            self._body.of(number, posterior),
        )


def standard_blocks(
    subject: Subject,
    markers: Sequence[str] | None = None,
    plates: Sequence[PlateReadings] = (),
    rate_hz: float = 100.0,
    *,
    settings: ReconstructSettings | None = None,
) -> list[AnyBlock]:
    """The blocks with which the dynamic filter follows a person, to be completed by one's own.

    Args:
        subject: The scaled person.
        markers: (M,) names of the markers, as for :class:`Tracker`.
        plates: The force plates.
        rate_hz: Frame rate.
        settings: Settings of the blocks.

    Raises:
        NotObservable: Too few of the subject's markers are among the markers.
    """
    settings = settings or ReconstructSettings()
    return standard(_inputs(subject, markers, plates, rate_hz, settings).inputs)


def _marker_names(subject: Subject, markers: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(marker.name for marker in subject.markers) if markers is None else tuple(markers)


def _inputs(
    subject: Subject,
    markers: Sequence[str] | None,
    plates: Sequence[PlateReadings],
    rate_hz: float,
    settings: ReconstructSettings,
) -> LiveInputs:
    names = _marker_names(subject, markers)
    return live_inputs(names, rate_hz, tuple(plates), subject, settings)
