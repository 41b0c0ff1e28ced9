"""Two people change one marker set: their changes are merged marker by marker."""

from __future__ import annotations

from dataclasses import replace

from mbkf.io.merging import merged
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.model.protocol_file import protocol_text


def merged_sets(
    base: Protocol, mine: Protocol, theirs: Protocol, over: bool = False
) -> tuple[Protocol, tuple[str, ...]]:
    """Lays the change from ``base`` to ``mine`` over ``theirs``.

    Args:
        base: The set before both changes.
        mine: The set with the late change.
        theirs: The set now.
        over: Keep the late change of markers that both changed differently, instead of the present state.

    Returns:
        The set with both changes, named as ``mine``, and the markers that both changed differently.
    """
    own = _states(mine)
    found = merged(_states(base), own, _states(theirs))
    states = {**found.table, **{one.field[0]: one.mine for one in found.differences if over}}
    markers: dict[str, ProtocolMarker] = {}
    ignored: dict[str, str] = {}
    for name, state in states.items():
        source = mine if own.get(name) == state else theirs
        markers |= {one.name: one for one in source.markers if one.name == name}
        ignored |= {one: reason for one, reason in source.ignored.items() if one == name}
    both = replace(mine, markers=tuple(markers.values()), ignored=ignored)
    return both, tuple(one.field[0] for one in found.differences)


def _states(protocol: Protocol) -> dict[str, str]:
    """Each marker's entry in the file of a set, by name; for one that is left out, the reason."""
    single = replace(protocol, source="", title="", name="", ignored={})
    states = {one.name: protocol_text(replace(single, markers=(one,))) for one in protocol.markers}
    return states | {name: f"left out: {reason}" for name, reason in protocol.ignored.items()}
