"""Scaled analog samples of a C3D file: (sample − OFFSET) · SCALE · GEN_SCALE, of numbers with or without a sign.

OFFSET is stored as a 16-bit number with a sign. Where the samples have none (ANALOG:FORMAT UNSIGNED, or an offset that
is the middle of such a range), an offset of −32768 stands for 32768. Floats keep whatever range they were converted
from, so their own size decides.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.records import SampleScaling

_UNSIGNED_OFFSET = -16384
"""An analog offset below this, read with a sign, is the middle of an unsigned range."""

_BLOCK = 512
"""Samples of all channels that are scaled at once, so that they stay in the processor's cache."""

ANALOG_SCALING = ("OFFSET", "SCALE", "GEN_SCALE")
"""Parameters of ANALOG without which samples have no size."""

TAKEN_AS_UNSIGNED = "analog samples are taken as numbers without a sign, since their OFFSET is that of such"


def scaled_samples(
    samples: Array, channels: int, parameters: C3dParameters, integers: bool
) -> tuple[Array, tuple[str, ...]]:
    """(C, S) scaled channels and remarks; a missing OFFSET is 0, a missing SCALE or GEN_SCALE 1.

    Args:
        samples: (T, C · samples per frame) numbers as they are stored.
        channels: Number of channels C.
        parameters: The file's parameters.
        integers: True for 16-bit integers, False for floats.
    """
    if not channels or not samples.size:
        return np.zeros((0, 0)), ()
    scale, general, offset = _stated_scaling(parameters, channels)
    stated = parameters.text("ANALOG", "FORMAT").upper().startswith("UNSIGNED")
    likely = stated or bool((parameters.all_numbers("ANALOG", "OFFSET") < _UNSIGNED_OFFSET).any())
    raw = samples.reshape(-1, channels).T
    unsigned = likely and (integers or _fit_unsigned(raw, offset))
    if unsigned:
        raw, offset = raw % 65536 if integers else raw, offset % 65536
    scaled, gain = np.empty(raw.shape), (scale * general)[:, None]
    with np.errstate(all="ignore"):  # samples of a damaged file may be any number, or none
        for begin in range(0, raw.shape[1], _BLOCK):
            block = slice(begin, begin + _BLOCK)
            scaled[:, block] = (raw[:, block] - offset[:, None]) * gain
    remarks = [TAKEN_AS_UNSIGNED] if unsigned and not stated else []
    counts = {name: parameters.all_numbers("ANALOG", name).size for name in ANALOG_SCALING}
    missing = [f"ANALOG:{name}" for name, count in counts.items() if not count]
    remarks += [
        f"ANALOG:{name} holds {counts[name]} of {channels} channels; channels without are scaled with {default:g}"
        for name, default in (("OFFSET", 0.0), ("SCALE", 1.0))
        if 0 < counts[name] < channels
    ]
    if missing:
        remarks.append(
            f"the file lacks {', '.join(missing)}: analog samples are scaled without; compare the plates with body "
            "weight, or give their readings with --forces"
        )
    return scaled, tuple(remarks)


def sample_scalings(parameters: C3dParameters, channels: int) -> tuple[SampleScaling, ...]:
    """The scaling of each channel; offsets as they are stored, with a sign."""
    scale, general, offset = _stated_scaling(parameters, channels)
    return tuple(SampleScaling(one, general, zero) for one, zero in zip(scale, offset, strict=True))


def stored_samples(values: Array, scaling: SampleScaling) -> Array:
    """(S,) samples that a reader of the format scales to the values (S,) again; 0 where the scale is 0.

    Counts of a converter, and floats without an offset, are found exactly: scaling rounds doubles, whose error is far
    below the last bit of a float.
    """
    gain = scaling.scale * scaling.general
    if not gain:
        return np.zeros(len(values))
    return np.asarray(np.float32(values / gain + scaling.offset), dtype=np.float64)


def _stated_scaling(parameters: C3dParameters, channels: int) -> tuple[Array, float, Array]:
    """(C,) scales, the general scale, and (C,) offsets; 1 and 0 where the file states none."""
    return (
        _filled(parameters.all_numbers("ANALOG", "SCALE"), channels, 1.0),
        parameters.number("ANALOG", "GEN_SCALE", 1.0) or 1.0,
        _filled(parameters.all_numbers("ANALOG", "OFFSET"), channels, 0.0),
    )


def _fit_unsigned(raw: Array, offset: Array) -> bool:
    """True where floats (C, S) lie nearer to the offsets (C,) without a sign than to those with one."""
    differ = offset < 0.0
    with np.errstate(all="ignore"):
        typical = np.median(raw[differ], axis=1)
        nearer = np.abs(typical - offset[differ] % 65536) < np.abs(typical - offset[differ])
    return bool(differ.any() and nearer.mean() > 0.5)


def _filled(values: Array, count: int, default: float) -> Array:
    """The first ``count`` values, defaults after them where there are fewer."""
    return np.concatenate([values[:count], np.full(max(count - len(values), 0), default)])
