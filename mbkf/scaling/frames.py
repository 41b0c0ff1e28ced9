"""Samples of the trials that enter scaling, on one common list of markers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.numerics.printed import percent

MIN_PRESENT = 0.05
"""Least share of the chosen frames of a trial in which a marker is seen: those of standing, which may be a single
frame, show markers that the moving trials lack."""

MIN_MARKERS = 6
"""Least number of markers in a frame: fewer do not determine a pelvis and a limb."""


@dataclass(frozen=True)
class ScalingFrames:
    """The chosen samples.

    Attributes:
        markers: The M protocol markers seen.
        measured_m: (N, M, 3) positions, NaN where missing.
        trial: (N,) index of the trial a frame came from.
        left_out: Reason by name of each of the captures' markers that is left out.
    """

    markers: tuple[ProtocolMarker, ...]
    measured_m: Array
    trial: Array
    left_out: dict[str, str]


def choose_frames(trials: Sequence[MarkerTrajectories], protocol: Protocol, per_trial: int) -> ScalingFrames:
    """Evenly spread, well-seen frames of every trial, on the markers of the protocol.

    Args:
        trials: The trials.
        protocol: The marker protocol.
        per_trial: Greatest number of frames of each trial.

    Raises:
        NotObservable: Too few markers of the protocol, or no frame that shows enough of them.
    """
    left_out: dict[str, str] = {}
    matches = [protocol.match(trial.names) for trial in trials]
    present = {marker.name for match in matches for marker in match.values()}
    for trial, match in zip(trials, matches, strict=True):
        left_out.update({n: "not a marker of the protocol" for n in trial.names if n not in match})
    markers = tuple(m for m in protocol.markers if m.name in present)
    if len(markers) < MIN_MARKERS:
        names = ", ".join(trials[0].names[:6]) or "none"
        raise NotObservable(
            f"the trial has {len(markers)} markers of protocol '{protocol.name}' (its own: {names}), scaling needs "
            f"{MIN_MARKERS}; give --protocol"
        )
    column = {marker.name: i for i, marker in enumerate(markers)}
    blocks, sources = [], []
    for index, (trial, match) in enumerate(zip(trials, matches, strict=True)):
        block = np.full((trial.frames, len(markers), 3), np.nan)
        for i, name in enumerate(trial.names):
            if name in match:
                block[:, column[match[name].name]] = trial.positions_m[:, i]
        chosen = _well_seen(block, per_trial)
        blocks.append(block[chosen])
        sources.append(np.full(len(chosen), index))
    measured = np.concatenate(blocks)
    if len(measured) == 0:
        raise NotObservable(
            f"no frame shows {MIN_MARKERS} markers of protocol '{protocol.name}' at once; give --protocol, or a "
            "capture with fewer gaps"
        )
    source = np.concatenate(sources)
    seen = ~np.isnan(measured).any(axis=2)
    share = np.max([seen[source == index].mean(axis=0) for index in np.unique(source)], axis=0)
    keep = share >= MIN_PRESENT
    left_out.update(
        {
            m.name: f"seen in {percent(s)} of the frames"
            for m, s, kept in zip(markers, share, keep, strict=True)
            if not kept
        }
    )
    kept_markers = tuple(m for m, kept in zip(markers, keep, strict=True) if kept)
    return ScalingFrames(kept_markers, measured[:, keep], source, left_out)


def _well_seen(block: Array, count: int) -> NDArray[np.intp]:
    """Frame numbers: the best-seen frame of each of ``count`` equal parts of the trial."""
    seen = (~np.isnan(block).any(axis=2)).sum(axis=1)
    best = seen.max(initial=0)
    enough = np.flatnonzero(seen >= max(MIN_MARKERS, 0.6 * best))
    if len(enough) <= count:
        return enough
    parts = np.array_split(enough, count)
    return np.array([part[np.argmax(seen[part])] for part in parts])
