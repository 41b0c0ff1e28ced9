"""Channels of recorders, each with a label and a unit, as signals of inertial sensors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.imu.column_names import ColumnName, parse_column_name
from mbkf.io.imu.signals import Signal, signal_width
from mbkf.io.imu.units import UNITS, plain_unit, unit_name


@dataclass(frozen=True)
class Channel:
    """A channel of a recorder.

    Attributes:
        label: Its label.
        unit: Its unit as the recorder states it, or "".
        values: (T,) its readings.
    """

    label: str
    unit: str
    values: Array


def channel_signals(
    path: Path,
    channels: Sequence[Channel],
    time_s: Array,
    *,
    units: Mapping[str, str] | None = None,
    sensor: str = "",
    kind: str = "",
) -> list[Signal]:
    """The signals of channels that share a clock; other channels, and quantities that lack an axis, are left out.

    Args:
        path: The file, for messages.
        channels: The channels.
        time_s: (T,) their times, s.
        units: Units that the caller states; they overrule the recorder's.
        sensor: Name of the sensor where labels do not name one.
        kind: Quantity where labels are x, y and z only.

    Raises:
        InvalidInput: A unit is stated nowhere, or is an electrical one.
        UnknownName: Unknown unit.
    """
    given = {name: unit_name(name, unit, "--units") for name, unit in (units or {}).items()}
    groups = dict[tuple[str, str], dict[int, tuple[Channel, ColumnName]]]()
    for channel in channels:
        name = parse_column_name(channel.label, kind)
        if name is not None:
            group = groups.setdefault((name.sensor or sensor, name.kind), {})
            if name.axis not in group or name.wide:
                group[name.axis] = channel, name
    found, unknown = list[Signal](), list[tuple[str, Channel]]()
    for (owner, quantity), group in groups.items():
        if sorted(group) != list(range(signal_width(quantity))):
            continue
        columns = []
        for axis in sorted(group):
            channel, name = group[axis]
            factor = _factor("acc" if quantity == "free" else quantity, channel.unit or name.unit, given)
            if factor is None:
                unknown.append(("acc" if quantity == "free" else quantity, channel))
            with np.errstate(over="ignore", invalid="ignore"):  # numbers that are too large are refused later
                columns.append((factor or 1.0) * channel.values)
        found.append(Signal(owner, quantity, time_s, np.stack(columns, axis=1)))
    if unknown:
        kinds = ",".join(
            f"{one}={next(iter(UNITS[one]))}" for one in dict.fromkeys(one for one, _ in unknown)
        )
        first = unknown[0][1]
        raise InvalidInput(
            f"{path}: channel '{first.label}' states "
            + (f"the unit '{first.unit}', which its quantity does not have" if first.unit else "no unit")
            + f"; state its unit, as in --units {kinds}"
        )
    return found


def _factor(kind: str, unit: str, given: Mapping[str, str]) -> float | None:
    """Factor to SI, None where the unit is not known."""
    if kind == "quat":
        return 1.0
    plain = given.get(kind) or plain_unit(kind, unit)
    return None if plain is None else UNITS[kind][plain]
