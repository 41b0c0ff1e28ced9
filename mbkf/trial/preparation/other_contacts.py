"""Before a trial is filtered: which parts of the body bear load besides the feet, from its markers and plates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Recording
from mbkf.sensors.contact.offline import assign_feet
from mbkf.sensors.supports.block import BEARING
from mbkf.sensors.supports.search import other_contacts
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.markers_alone import Motion


def with_other_contacts(
    inputs: FilterInputs, recording: Recording, times_s: Array, motion: Motion
) -> tuple[FilterInputs, Recording]:
    """Inputs and readings with the parts that bear load besides the feet; unchanged without such a part.

    Args:
        inputs: Inputs of the filters.
        recording: Readings of the instruments.
        times_s: (T,) times of the frames.
        motion: The motion by markers alone.
    """
    if not inputs.sensor.model.description.bearings:
        return inputs, recording
    q, v = motion
    model, rate_hz = inputs.sensor.model, 1.0 / inputs.dt_s
    loads = assign_feet(model, q, times_s, rate_hz, inputs.plates)
    plates = recording.plates
    read = np.full(len(plates), plates.shape[1] > 0) & ~np.isnan(plates).any(axis=(1, 2))
    found = other_contacts(model, q, v, rate_hz, loads, read)
    inputs = replace(inputs, remarks=(*inputs.remarks, *found.remarks))
    if not found.flags.any():
        return inputs, recording
    readings = {**recording.readings, BEARING: found.flags.astype(float)}
    return replace(inputs, other_contacts=True), replace(recording, readings=readings)
