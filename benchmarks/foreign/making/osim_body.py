"""A body of OpenSim as arrays: places of markers and bodies, inverse dynamics, and loads on a body's dofs.

All in OpenSim's axes (y up) and units (rad, m, N, N m). Coordinates stand in the model's own order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.required import opensim
from mbkf.conventions import Array
from mbkf.errors import InvalidInput

ROOT = 6
"""The first coordinates: tilt, list and rotation of the pelvis, and its position."""

GRAVITY = np.array([0.0, -9.80665, 0.0])


@dataclass(frozen=True)
class Size:
    """Differences of a body from the model that it is made from.

    Attributes:
        factors: Factors on length along x, y, z by body.
        mass_kg: Mass after scaling.
        masses: Factors on the mass of bodies after that.
    """

    factors: Mapping[str, Sequence[float]]
    mass_kg: float
    masses: Mapping[str, float]


class OsimBody:
    """A model without muscles whose coordinates can all move.

    Attributes:
        model: OpenSim's model.
        names: (C,) coordinates.
        mass_kg: Total mass.
    """

    def __init__(
        self,
        path: Path,
        size: Size | None = None,
        places: Mapping[str, tuple[str, Sequence[float]]] | None = None,
    ) -> None:
        """Makes it.

        Args:
            path: The model's file.
            size: How the body differs; as the file has it when None.
            places: Markers in place of the model's own, by name: body, and place before scaling.
        """
        osim = opensim()
        model = self.model = osim.Model(str(path))
        model.updForceSet().clearAndDestroy()
        model.updControllerSet().clearAndDestroy()
        if places:
            model.updMarkerSet().clearAndDestroy()
        for name, (body, place) in (places or {}).items():
            model.addMarker(osim.Marker(name, model.getBodySet().get(body), osim.Vec3(*map(float, place))))
        model.finalizeConnections()
        state = model.initSystem()
        if size is not None:
            self._scale(size, state)
        self.state = model.initSystem()
        coordinates = [model.getCoordinateSet().get(k) for k in range(model.getCoordinateSet().getSize())]
        for one in coordinates:
            one.setLocked(self.state, False)
        self.names = tuple(one.getName() for one in coordinates)
        self._dof = self._places_in_state(coordinates)
        self.mass_kg = float(model.getTotalMass(self.state))
        self._solver = osim.InverseDynamicsSolver(model)
        self._matter = model.getMatterSubsystem()
        self._bodies: dict[str, Any] = {}
        self._markers: dict[str, Any] = {}

    def _scale(self, size: Size, state: Any) -> None:
        osim = opensim()
        scales = osim.ScaleSet()
        for body, factors in size.factors.items():
            one = osim.Scale()
            one.setSegmentName(body)
            one.setScaleFactors(osim.Vec3(*map(float, factors)))
            one.setApply(True)
            scales.cloneAndAppend(one)
        self.model.scale(state, scales, True, float(size.mass_kg))
        for body, factor in size.masses.items():
            found = self.model.updBodySet().get(body)
            inertia = found.get_inertia()
            found.setMass(found.getMass() * factor)
            found.set_inertia(osim.Vec6(*[inertia.get(k) * factor for k in range(6)]))

    def _places_in_state(self, coordinates: Sequence[Any]) -> Array:
        """(C,) where each coordinate stands in the state."""
        found = []
        for one in coordinates:
            for other in coordinates:
                other.setSpeedValue(self.state, 0.0)
            one.setSpeedValue(self.state, 1.0)
            found.append(int(np.argmax(self.state.getU().to_numpy())))
        return np.array(found)

    def column(self, name: str) -> int:
        """Place of a coordinate.

        Raises:
            InvalidInput: The model has no such coordinate.
        """
        if name not in self.names:
            raise InvalidInput(f"the model has no coordinate '{name}'")
        return self.names.index(name)

    def move(self, q: Array, u: Array | None = None) -> None:
        """Puts the body in a pose, with rates (0 by default).

        Args:
            q: (C,) coordinates.
            u: (C,) their rates.
        """
        self.state.setQ(self._vector(q))
        self.state.setU(self._vector(np.zeros(len(q)) if u is None else u))
        self.model.realizeVelocity(self.state)

    def markers(self, names: Sequence[str]) -> Array:
        """(M, 3) places of markers in the present pose.

        Args:
            names: Their names.
        """
        for name in names:
            if name not in self._markers:
                self._markers[name] = self.model.getMarkerSet().get(name)
        return np.array([_array(self._markers[name].getLocationInGround(self.state)) for name in names])

    def marker_body(self, name: str) -> str:
        """Name of the body that a marker is on."""
        return str(self.model.getMarkerSet().get(name).getParentFrameName()).split("/")[-1]

    def frame(self, body: str) -> tuple[Array, Array]:
        """Rotation (3, 3) and origin (3,) of a body in the present pose.

        Args:
            body: Its name.
        """
        placed = self._body(body).getTransformInGround(self.state)
        turned = placed.R().asMat33()
        return np.array([[turned.get(i, j) for j in range(3)] for i in range(3)]), _array(placed.p())

    def centre_of_mass(self) -> Array:
        """(3,) in the present pose."""
        return _array(self.model.calcMassCenterPosition(self.state))

    def inertia(self) -> Array:
        """(3, 3) of the whole body about its centre of mass, in the present pose."""
        found = self._matter.calcSystemCentralInertiaInGround(self.state)
        return _symmetric([*_array(found.getMoments()), *_array(found.getProducts())])

    def torques(self, a: Array) -> Array:
        """(C,) generalised forces without loads in the present pose and rates, with the pelvis's residuals.

        Args:
            a: (C,) accelerations.
        """
        return np.asarray(self._solver.solve(self.state, self._vector(a)).to_numpy()[self._dof])

    def by_load(self, body: str, wrench: Array) -> Array:
        """(C,) generalised forces that a wrench on a body has in the present pose.

        Args:
            body: Its name.
            wrench: (6,) force and moment about the ground's origin.
        """
        osim = opensim()
        part = self._body(body)
        force, moment = (
            wrench[:3],
            wrench[3:] - np.cross(_array(part.getPositionInGround(self.state)), wrench[:3]),
        )
        spatial = osim.SpatialVec(osim.Vec3(*moment.tolist()), osim.Vec3(*force.tolist()))
        found = osim.Vector(len(self.names), 0.0)
        index = part.getMobilizedBodyIndex()
        self._matter.multiplyByFrameJacobianTranspose(self.state, index, osim.Vec3(0.0), spatial, found)
        return np.asarray(found.to_numpy()[self._dof])

    def residual_wrench(self, torques: Array) -> Array:
        """(6,) wrench about the ground's origin that does what the pelvis's residuals do.

        Args:
            torques: (C,) of :meth:`torques`.
        """
        columns = np.column_stack([self.by_load("pelvis", unit)[:ROOT] for unit in np.eye(6)])
        return np.asarray(np.linalg.solve(columns, torques[:ROOT]))

    def momentum(self, bodies: Sequence[str]) -> tuple[Array, Array]:
        """(3,) linear momentum of some bodies, and (3,) angular momentum about the ground's origin.

        Args:
            bodies: Their names.
        """
        linear, angular = np.zeros(3), np.zeros(3)
        for name in bodies:
            turned, origin = self.frame(name)
            part = self._body(name)
            omega = _array(part.getAngularVelocityInGround(self.state))
            place = turned @ _array(part.get_mass_center())
            speed = _array(part.getLinearVelocityInGround(self.state)) + np.cross(omega, place)
            inertia = _symmetric([part.get_inertia().get(k) for k in range(6)])
            push = part.getMass() * speed
            linear += push
            angular += np.cross(origin + place, push) + turned @ inertia @ turned.T @ omega
        return linear, angular

    def weight(self, bodies: Sequence[str]) -> Array:
        """(6,) weight of some bodies as a wrench about the ground's origin.

        Args:
            bodies: Their names.
        """
        found = np.zeros(6)
        for name in bodies:
            turned, origin = self.frame(name)
            part = self._body(name)
            force = part.getMass() * GRAVITY
            found[:3] += force
            found[3:] += np.cross(origin + turned @ _array(part.get_mass_center()), force)
        return found

    def _body(self, name: str) -> Any:
        if name not in self._bodies:
            self._bodies[name] = self.model.getBodySet().get(name)
        return self._bodies[name]

    def _vector(self, values: Array) -> Any:
        placed = np.zeros(len(values))
        placed[self._dof] = values
        found = opensim().Vector(len(placed), 0.0)
        for k, value in enumerate(placed.tolist()):
            found.set(k, value)
        return found


def _array(vector: Any) -> Array:
    return np.array([vector.get(k) for k in range(3)])


def _symmetric(values: Sequence[float]) -> Array:
    """(3, 3) of xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
