"""Degrees of freedom that a marker protocol determines, and those lost with named markers."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from mbkf.errors import NotObservable, UnknownName
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.sensors.observability import Observability, analyse


@dataclass(frozen=True)
class ProtocolObservability:
    """Observability of the reference body by a protocol.

    Attributes:
        protocol: The protocol.
        markers: Names of the markers that were counted, without the lost ones.
        lost: Names of the markers taken away.
        before: Observability with all markers.
        after: Observability with the remaining ones; the same as ``before`` when no marker is lost.
    """

    protocol: Protocol
    markers: tuple[str, ...]
    lost: tuple[str, ...]
    before: Observability
    after: Observability

    @property
    def lost_dofs(self) -> tuple[str, ...]:
        """Dofs that are determined in every posture before the loss, and not in every posture after it."""
        seen_before = (
            set(self.before.dofs) - set(self.before.unobserved) - set(self.before.sometimes_unobserved)
        )
        blind_after = set(self.after.unobserved) | set(self.after.sometimes_unobserved)
        return tuple(name for name in self.before.dofs if name in seen_before & blind_after)


def check_protocol(protocol: Protocol, lost: Collection[str] = ()) -> ProtocolObservability:
    """Observability of a protocol on its reference body, and without the lost markers.

    Computed points (joint centres) are left out: they are never tracked.

    Args:
        protocol: The protocol.
        lost: Names or aliases of lost markers.

    Raises:
        UnknownName: A lost marker is not one of the protocol's.
        NotObservable: No marker is left.
    """
    followed, gone = followed_markers(protocol), lost_markers(protocol, lost)
    left = [marker for marker in followed if marker.name not in gone]
    model = HumanModel.scaled(body=protocol.body)
    before = _analyse(model, followed)
    return ProtocolObservability(
        protocol=protocol,
        markers=tuple(marker.name for marker in left),
        lost=gone,
        before=before,
        after=_analyse(model, left) if gone else before,
    )


def followed_markers(protocol: Protocol) -> list[ProtocolMarker]:
    """The markers that are tracked: all but computed points."""
    return [marker for marker in protocol.markers if marker.kind != "computed"]


def lost_markers(protocol: Protocol, lost: Collection[str]) -> tuple[str, ...]:
    """Names of lost markers, each once.

    Args:
        protocol: The protocol.
        lost: Their names or aliases.

    Raises:
        UnknownName: A lost marker is not one of the protocol's.
        NotObservable: No marker is left.
    """
    followed = followed_markers(protocol)
    known = {marker.name: marker.name for marker in followed}
    aliases = {alias: marker.name for marker in followed for alias in marker.aliases}
    names = aliases | known
    for name in lost:
        if name not in names:
            raise UnknownName("marker", name, known, f"protocol {protocol.name}")
    gone = tuple(dict.fromkeys(names[name] for name in lost))
    if len(gone) == len(followed):
        raise NotObservable(
            f"protocol {protocol.name} has no marker left without the {len(gone)} lost ones; give fewer"
        )
    return gone


def _analyse(model: HumanModel, markers: list[ProtocolMarker]) -> Observability:
    return analyse(
        model,
        [marker.segment for marker in markers],
        np.array([marker.position_m for marker in markers]),
        np.array([marker.noise_m for marker in markers]),
    )
