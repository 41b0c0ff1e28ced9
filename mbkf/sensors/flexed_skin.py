"""Skin that moves with the joints: displacements of markers in their segments' frames by flexion.

A marker is at p + Σ_d f(θ_d) c_d, with θ_d the flexions of the joints beside its segment and c_d its displacement at
:data:`FLEXED_RAD`. f(θ) = sin(θ/2) / sin(FLEXED_RAD/2) is 0 in the neutral posture and saturates: in bone-pin and
fluoroscopic studies skin moves in proportion to flexion, and less so when deep (Reinschmidt et al. 1997,
Akbarshahi et al. 2010). The body file has the spread of c_d
(:class:`mbkf.model.description.SegmentSkin`).
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.model.description import BodyDescription
from mbkf.sensors.posture_sensor import PostureSensor

FLEXED_RAD = np.pi / 3.0
"""Flexion at which a displacement is stated, rad."""

UNMOVED_M = 1e-3
"""Spread of displacements whose share is always zero, m: they stay at zero, whatever it is."""


class FlexedSkin:
    """Shares of the displacements c in the places of M markers.

    Attributes:
        flexions: D, the greatest number of flexions that move a segment's skin; markers with fewer have zero shares.
    """

    def __init__(self, model: Body, segments: Sequence[str]) -> None:
        """Prepares the shares.

        Args:
            model: A body of the description.
            segments: (M,) segment of each marker; "" for one that no skin carries.
        """
        skin = model.description.skin
        self.flexions = flexions_of(model.description, segments)
        self._posture = PostureSensor(model)
        turning = np.zeros((len(segments), self.flexions, model.nv))
        for m, name in enumerate(segments):
            for d, joints in enumerate(skin[name].flexions if name in skin else ()):
                for joint in joints:
                    turning[m, d, _bending_dof(model, joint)] = 1.0 / len(joints)
        # markers of one segment share their flexions, each computed once
        self._turning, which = np.unique(turning.reshape(-1, model.nv), axis=0, return_inverse=True)
        self._which = which.reshape(turning.shape[:2])

    def shares(self, q: Array) -> Array:
        """(M, D) f(θ) at a configuration q (nq,)."""
        return self.shares_of(self._posture.deviation(q)[0])

    def shares_of(self, deviations: Array) -> Array:
        """(…, M, D) f(θ) where joints are turned by (…, nv) rad from neutral."""
        return _share(deviations @ self._turning.T)[..., self._which]

    @property
    def carried(self) -> BoolArray:
        """(M, D) True where a flexion moves a marker."""
        return np.asarray(np.asarray(self._turning.any(axis=1))[self._which])

    def only(self, markers: NDArray[np.intp]) -> FlexedSkin:
        """The shares of some of the markers, by their numbers."""
        some = copy(self)
        some._which = self._which[markers]
        return some

    def displacement(self, slides_m: Array) -> SkinDisplacement:
        """The displacement of the markers as a function of the configuration.

        Args:
            slides_m: (M, D, 3) displacement of each marker by each flexion, m.
        """
        return SkinDisplacement(self._posture, self._turning, self._which, slides_m)

    def add_by_poses(
        self, by_pose: Array, moved: Array, deviations: Array, jacobians: Sequence[Array]
    ) -> None:
        """Adds the displacements' derivatives to those of the markers' places by N poses.

        Args:
            by_pose: (N, M, 3, nv) derivatives; changed.
            moved: (N, M, 3, D) displacement of each marker by a share of 1.
            deviations: (N, nv) turns of the joints from neutral, rad.
            jacobians: (nv, nv) their derivative in each pose.
        """
        theta = deviations @ self._turning.T
        slopes = 0.5 * np.cos(0.5 * theta) / np.sin(0.5 * FLEXED_RAD)
        by_q = slopes[:, :, None] * np.array([self._turning @ one for one in jacobians])
        for flexion in np.flatnonzero(self._turning.any(axis=1)):
            markers, kinds = np.nonzero(self._which == flexion)
            dofs = np.flatnonzero((by_q[:, flexion] != 0.0).any(axis=0))  # those of the joints that bend
            each = moved[:, markers, :, kinds].swapaxes(0, 1)
            along = each[..., None] * by_q[:, None, None, flexion, dofs]
            by_pose[:, markers[:, None, None], np.arange(3)[:, None], dofs] += along


class SkinDisplacement:
    """Σ_d f(θ_d) c_d of M markers with known c."""

    def __init__(
        self, posture: PostureSensor, turning: Array, which: NDArray[np.intp], slides_m: Array
    ) -> None:
        """Prepares the sum.

        Args:
            posture: Rotations of the joints.
            turning: (F, nv) share of each rotation in each flexion.
            which: (M, D) flexions that move the markers.
            slides_m: (M, D, 3) displacements c, m.
        """
        count = len(slides_m)
        self._posture, self._turning = posture, turning
        by_flexion = np.zeros((3 * count, len(self._turning)))
        slides = np.moveaxis(slides_m, 1, 2).reshape(3 * count, -1)
        of_marker = np.repeat(which.reshape(count, -1), 3, axis=0)
        np.add.at(by_flexion, (np.arange(3 * count)[:, None], of_marker), slides)
        self._by_flexion = by_flexion

    def at(self, q: Array) -> Array:
        """(M, 3) displacement at q (nq,), m."""
        theta = self._turning @ self._posture.deviation(q)[0]
        return (self._by_flexion @ _share(theta)).reshape(-1, 3)


def _share(theta: Array) -> Array:
    return np.asarray(np.sin(0.5 * theta) / np.sin(0.5 * FLEXED_RAD))


def _bending_dof(model: Body, segment: str) -> int:
    """The dof that turns a joint about y: a hinge's only one, of other joints the second."""
    dofs = model.joint(segment).v
    return dofs.start if dofs.stop - dofs.start == 1 else dofs.start + 1


def slide_covariance(body: BodyDescription, segments: Sequence[str]) -> Array:
    """(D, 3 M, 3 M) prior covariances of the displacements of M markers by each flexion, m².

    Args:
        body: The reference body.
        segments: (M,) segment of each marker; "" for one that no skin carries.
    """
    names = np.array(segments)
    together = UNMOVED_M**2 * np.eye(len(names))
    for name in set(segments) & set(body.skin):
        here, skin = np.flatnonzero(names == name), body.skin[name]
        together[np.ix_(here, here)] = skin.common_m**2 + skin.own_m**2 * np.eye(len(here))
    return np.repeat(np.kron(together, np.eye(3))[None], flexions_of(body, segments), axis=0)


def flexions_of(body: BodyDescription, segments: Sequence[str]) -> int:
    """D: the greatest number of flexions that move the skin of one of some segments."""
    return max((len(body.skin[name].flexions) for name in segments if name in body.skin), default=0)
