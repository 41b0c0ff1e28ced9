"""Before a trial is filtered: which parts of the body bear load besides the feet, from its markers and plates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Recording
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.model.body import Body
from mbkf.sensors.contact.offline import FootLoads, assign_feet
from mbkf.sensors.contact.plates import surface_height
from mbkf.sensors.supports.block import BEARING
from mbkf.sensors.supports.search import other_contacts
from mbkf.trial.loads.balance import LoadBalance
from mbkf.trial.loads.opening import ContactOpener
from mbkf.trial.loads.unexplained import unexplained_loads
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.markers_alone import Motion
from mbkf.trial.preparation.settings import ReconstructSettings

EVERYWHERE = ("mass", "clock")
"""Causes that hold throughout a trial."""


def with_other_contacts(
    inputs: FilterInputs, recording: Recording, times_s: Array, motion: Motion, missing: bool = True
) -> tuple[FilterInputs, Recording]:
    """Inputs and readings with the parts that bear load besides the feet; unchanged without such a part.

    Parts are found by the force that plates lack, and by lying on the floor where plates do not judge.

    Args:
        inputs: Inputs of the filters.
        recording: Readings of the instruments.
        times_s: (T,) times of the frames.
        motion: The motion by markers alone.
        missing: False where a missing force is not searched: a causal filter opens those contacts on its way.
    """
    if not inputs.sensor.model.description.bearings:
        return inputs, recording
    q, v = motion
    model, rate_hz = inputs.sensor.model, 1.0 / inputs.dt_s
    plates = recording.plates
    loads = assign_feet(model, q, times_s, rate_hz, inputs.plates, plates)
    read = np.full(len(plates), plates.shape[1] > 0) & ~np.isnan(plates).any(axis=(1, 2))
    judged = contradictions(model, q, times_s, rate_hz, loads, read)
    doubted = _doubted(judged, times_s) if missing else np.ones(len(q), dtype=bool)
    found = other_contacts(model, q, v, rate_hz, loads, read, doubted, inputs.unobservable)
    inputs = replace(inputs, remarks=(*inputs.remarks, *found.remarks), contradictions=judged)
    if not found.flags.any():
        return inputs, recording
    readings = {**recording.readings, BEARING: found.flags.astype(float)}
    return replace(inputs, other_contacts=True), replace(recording, readings=readings)


def contact_opener(inputs: FilterInputs, settings: ReconstructSettings) -> ContactOpener | None:
    """Opens contacts of other parts than the feet while a motion goes on.

    Args:
        inputs: Inputs of the filters.
        settings: The filter, and whether contacts are looked for.

    Returns:
        None where the filter has no such contacts, or nothing reads the feet's loads.
    """
    bearings = inputs.sensor.model.description.bearings
    if not settings.other_contacts or settings.filter != "dynamic" or not inputs.plates or not bearings:
        return None
    floor_m = min(surface_height(plate) for plate in inputs.plates)
    return ContactOpener(inputs.sensor.model, 1.0 / inputs.dt_s, floor_m, inputs.unobservable)


def contradictions(
    model: Body, q: Array, times_s: Array, rate_hz: float, loads: FootLoads, read: BoolArray
) -> tuple[UnexplainedLoad, ...]:
    """Unexplained forces by the motion of markers alone: causes show best before a filter has made readings agree.

    Args:
        model: The body.
        q: (T, nq) configurations from markers alone.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        loads: Loads of the feet by the plates.
        read: (T,) frames in which all plates were recorded.
    """
    judged = read & ~loads.unread.any(axis=1)
    balance = LoadBalance.of(model, q, rate_hz, loads.wrench[..., :3], np.zeros((len(q), 3)), judged)
    return unexplained_loads(balance, times_s).loads


def _doubted(judged: Sequence[UnexplainedLoad], times_s: Array) -> BoolArray:
    """(T,) frames in which a wrong mass, unequal clocks or a foot beside its plate explains a missing force."""
    found = np.zeros(len(times_s), dtype=bool)
    for one in judged:
        if one.cause in EVERYWHERE:
            return ~found
        if one.cause:
            found |= (times_s >= one.from_s) & (times_s <= one.to_s)
    return found
