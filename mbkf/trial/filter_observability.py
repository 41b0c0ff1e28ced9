"""Components of a filter's state that markers and plates determine: torques and reactions among them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.dynamic.filter import DynamicFilter, dynamic_blocks
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.filter import Filter
from mbkf.filters.observability import (
    Component,
    StateObservability,
    components,
    state_observability,
    whitened,
)
from mbkf.filters.torque.filter import TorqueFilter
from mbkf.filters.torque.plant import ForcedState, TorquePlant
from mbkf.model.body import Body
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.given import GivenContact
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.observability import SHARE_THRESHOLD, generic_postures
from mbkf.trial.observability import followed_markers, lost_markers
from mbkf.trial.preparation.settings import ReconstructSettings

FEET = ("right", "left")
"""Feet, each with a plate of its own."""

COMPLETE, SIMPLIFIED, CUT = "complete F", "simplified F", "F without ∂z̈/∂T_e"
"""Sensitivities of the torque filter: thesis eq. 3.40; thesis eq. 4.15; and that without its only block of dynamics."""

PLANT, WITH_PRIORS = "the filter's plant", "with the filter's priors"

_DT_S = 0.01
_SPEED, _ACCELERATION, _SHEAR = 1.0, 5.0, 0.2


class _Motion(NamedTuple):
    """Configuration q, velocity v, acceleration a and wrenches (2, 6) of the feet about the world's origin."""

    q: Array
    v: Array
    a: Array
    wrench: Array


class _Point(NamedTuple):
    """A filter at an operating point: whitened readings, those with priors too, and each F by its name."""

    rows: Array
    with_priors: Array
    slopes: dict[str, Array]


@dataclass(frozen=True)
class FilterObservability:
    """Observability of a filter's state in P operating points, the first of them standing still.

    Attributes:
        protocol: The marker protocol.
        markers: Names of the markers that are counted.
        lost: Names of the lost markers.
        without: Feet whose plate is missing.
        filter: Name of the filter.
        state: Components of the state.
        variants: Observability at each point, by the name of F.
        own: The variant that the filter itself computes with.
    """

    protocol: Protocol
    markers: tuple[str, ...]
    lost: tuple[str, ...]
    without: tuple[str, ...]
    filter: str
    state: tuple[Component, ...]
    variants: dict[str, tuple[StateObservability, ...]]
    own: str

    @property
    def found(self) -> tuple[StateObservability, ...]:
        """Observability by the filter's own F."""
        return self.variants[self.own]

    @property
    def complete(self) -> bool:
        """True if readings determine every component in every point."""
        return all(one.rank == len(self.state) for one in self.found)

    @property
    def loads_given(self) -> bool:
        """True if the feet's wrenches are known inputs and not part of the state."""
        return all(one.part != f"{FEET[0]} foot" for one in self.state)

    @property
    def unobserved_share(self) -> Array:
        """(N,) median share of each component in the directions that no reading shows, over the moving points."""
        return np.asarray(np.median([one.unobserved_share for one in self.found[1:]], axis=0))

    @property
    def unobserved(self) -> tuple[Component, ...]:
        """Components that lie by more than a hundredth in such directions."""
        pairs = zip(self.state, self.unobserved_share, strict=True)
        return tuple(one for one, share in pairs if share > SHARE_THRESHOLD)


def plate_feet(names: Collection[str]) -> tuple[str, ...]:
    """Feet whose plates are named.

    Args:
        names: "right" or "1", "left" or "2", "both".

    Raises:
        UnknownName: Neither foot stands on a plate of that name.
    """
    known = {"right": FEET[:1], "left": FEET[1:], "1": FEET[:1], "2": FEET[1:], "both": FEET}
    for name in names:
        if name not in known:
            raise UnknownName("plate", name, known, "--without-plate")
    gone = {foot for name in names for foot in known[name]}
    return tuple(foot for foot in FEET if foot in gone)


def check_filter(
    protocol: Protocol,
    settings: ReconstructSettings,
    lost: Collection[str] = (),
    without: Collection[str] = (),
) -> FilterObservability:
    """Observability of the torque or dynamic filter's state by a protocol and a plate under each foot.

    Args:
        protocol: The protocol.
        settings: Names the filter, and holds its settings.
        lost: Names or aliases of lost markers.
        without: Feet whose plate is missing, as for :func:`plate_feet`.

    Raises:
        UnknownName: A lost marker is not one of the protocol's, or a plate does not exist.
        NotObservable: No marker is left.
        InvalidInput: The filter has no torques, or the body no feet.
    """
    gone, feet = lost_markers(protocol, lost), plate_feet(without)
    model = HumanModel.scaled(body=protocol.body)
    if len(model.roles.feet) != len(FEET):
        raise InvalidInput(f"body {protocol.body} has no pair of feet, so no plate reads its loads")
    markers, points = followed_markers(protocol), []
    made = _Maker(model, markers, {one.name for one in markers} - set(gone), feet, settings)
    for motion in _motions(model):
        kalman, point = made.at(motion)
        points.append(point)
    torques = "accelerating torque" if settings.torque.force_state == "inertial" else "torque"
    state = components(kalman.layout, model, torques)
    sizes = np.array([one.size for one in state])
    own = next(iter(points[0].slopes))
    variants = {
        name: tuple(state_observability(one.rows, one.slopes[name], sizes) for one in points)
        for name in points[0].slopes
    }
    variants[WITH_PRIORS] = tuple(
        state_observability(one.with_priors, one.slopes[own], sizes) for one in points
    )
    left = tuple(one.name for one in markers if one.name not in gone)
    return FilterObservability(protocol, left, gone, feet, settings.filter, state, variants, own)


def _motions(model: Body) -> list[_Motion]:
    """Standing still, and bent postures in motion with loads of all directions on both feet."""
    rng, feet, motions = np.random.default_rng(4), FeetOnBody(model), []
    weight = GRAVITY_M_S2 * model.mass_kg
    for k, q in enumerate(generic_postures(model)):
        moves = float(k > 0)
        v, a = (moves * size * rng.uniform(-1.0, 1.0, model.nv) for size in (_SPEED, _ACCELERATION))
        shear = moves * _SHEAR * weight * rng.uniform(-1.0, 1.0, (2, 2))
        force = np.column_stack([shear, np.full(2, 0.5 * weight)])
        motions.append(
            _Motion(q, v, a, np.hstack([force, np.cross(feet.at(q, np.zeros(model.nv)).middles_m, force)]))
        )
    return motions


class _Maker:
    """Makes a filter at an operating point; its blocks read the frame that the motion itself would give."""

    def __init__(
        self,
        model: Body,
        markers: list[ProtocolMarker],
        seen: set[str],
        without: tuple[str, ...],
        settings: ReconstructSettings,
    ) -> None:
        """Args: the body, its markers, names of those seen, feet without plate, and the filter with its settings."""
        self._model, self._settings = model, settings
        self._sensor = MarkerSensor(
            model, [one.segment for one in markers], np.array([one.position_m for one in markers])
        )
        self._noise_m = np.array([one.noise_m for one in markers])
        self._seen = np.array([one.name in seen for one in markers])
        right, left = (Contact.UNMEASURED if foot in without else Contact.MEASURED for foot in FEET)
        self._contacts = right, left

    def at(self, motion: _Motion) -> tuple[Filter, _Point]:
        """The filter, and its readings and sensitivities there."""
        detector = GivenContact(self._model, self._contacts, motion.wrench, _DT_S)
        known = self._sensor, self._noise_m
        free = np.zeros(self._model.nv, dtype=bool)
        if self._settings.filter == "torque":
            torque = TorqueFilter.standard(*known, detector, _DT_S, free, self._settings.torque)
            return torque, self._of_torque(torque, motion)
        if self._settings.filter == "dynamic":
            s = self._settings.dynamic
            blocks = dynamic_blocks(*known, detector, _DT_S, free, s)
            dynamic = DynamicFilter(*known, _DT_S, free, s, blocks)
            return dynamic, self._of_dynamic(dynamic, motion)
        raise InvalidInput(f"the state of the {self._settings.filter} filter holds no torques or reactions")

    def _of_torque(self, kalman: TorqueFilter, motion: _Motion) -> _Point:
        body, plant = kalman.body, kalman.plant
        a = np.where(body.kinematic, 0.0, motion.a)
        given = body.wrench_state(motion.q, motion.wrench) if body.loads_given else np.zeros(0)
        u = body.forces(motion.q, motion.v, a, motion.wrench)
        state = ForcedState(motion.q, motion.v, u, self._spread(kalman), given=given)
        slope = body.linearise(motion.q, motion.v, state.forces)

        def sensitivity(complete: bool) -> Array:
            scheme = replace(plant.scheme, complete=complete)
            wrenches = not body.loads_given
            same = TorquePlant(body, _DT_S, plant.density, scheme, plant.drift, wrenches=wrenches)
            return same.sensitivity(motion.v, slope)

        slopes = {COMPLETE: sensitivity(True), SIMPLIFIED: sensitivity(False)}
        if not plant.scheme.complete:
            slopes = dict(reversed(slopes.items()))
        slopes[CUT] = slopes[SIMPLIFIED].copy()
        slopes[CUT][plant.layout.v, plant.layout["u"]] = 0.0
        return self._point(kalman, state, slopes)

    def _of_dynamic(self, kalman: DynamicFilter, motion: _Motion) -> _Point:
        w, extra = motion.wrench.ravel(), kalman.layout.start()[0]
        state = DynamicState(motion.q, motion.v, motion.a, w, self._spread(kalman), extra)
        # Rows of powers of Φ and of F = (Φ − 1)/Δt span the same space.
        phi = kalman.plant.transition(state)
        return self._point(kalman, state, {PLANT: (phi - np.eye(len(phi))) / _DT_S})

    def _spread(self, kalman: Filter) -> Array:
        """(N, N) covariance in which every component is as uncertain as its typical size."""
        return np.diag([one.size**2 for one in components(kalman.layout, self._model)])

    def _point(self, kalman: Filter, state: ForcedState | DynamicState, slopes: dict[str, Array]) -> _Point:
        sizes = np.sqrt(np.diagonal(state.P))
        markers = np.where(self._seen[:, None], self._sensor.positions(state.q), np.nan)
        memory = kalman.begin()
        prior = kalman.prepared(state, kalman.plant.noise(memory.plant), memory)
        readings = kalman.correct(prior, memory, Frame(markers, np.zeros((0, 6)))).readings
        return _Point(whitened(readings, sizes), whitened(readings, sizes, priors=True), slopes)
