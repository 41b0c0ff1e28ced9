"""A walk as laboratories hand it on: half of it named, broken by gaps, and not worn as on the standing trial."""

from dataclasses import dataclass, replace

import numpy as np

from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise


@dataclass(frozen=True)
class Stairs:
    """The capture, its truth, the person scaled from the standing trial, and what differs between the two trials."""

    raw: Capture
    truth: MarkerTrajectories
    subject: Subject
    named: tuple[str, ...]
    moved: tuple[str, ...]
    dropped: tuple[str, ...]


def stairs(seed: int, shift_m: float = 0.03, seconds: float = 1.5) -> Stairs:
    """Two markers shifted on the static, three not worn in the walk, two ghosts, every track with a gap.

    Half of the trajectories keep their names; of the others every piece is a column of its own.
    """
    rng = np.random.default_rng(seed)
    person, made = synthesise("walk", seed=seed, seconds=seconds)
    names, frames = made.trial.markers.names, made.trial.markers.frames
    order = rng.permutation(len(names)).tolist()
    moved, dropped = order[:2], order[2:5]
    standing = made.static.markers.positions_m.copy()
    for k in moved:
        way = rng.normal(size=3)
        standing[:, made.static.markers.names.index(names[k])] += shift_m * way / np.linalg.norm(way)
    static = replace(made.static, markers=replace(made.static.markers, positions_m=standing))
    keep = [k for k in range(len(names)) if k not in dropped]
    shown = made.trial.markers.positions_m[:, keep].copy()
    for j in range(len(keep)):
        first = int(rng.integers(0, frames - 15))
        shown[first : first + int(rng.integers(3, 15)), j] = np.nan
    named, columns, labels = rng.random(len(keep)) < 0.5, [], []
    for j, k in enumerate(keep):
        there = ~np.isnan(shown[:, j, 0])
        edges = np.flatnonzero(np.diff(np.concatenate([[0], there.astype(int), [0]])))
        for first, end in [(0, frames)] if named[j] else zip(edges[::2], edges[1::2], strict=True):
            column = np.full((frames, 3), np.nan)
            column[first:end] = shown[first:end, j]
            columns.append(column)
            labels.append(names[k] if named[j] else f"*{len(labels)}")
    for _ in range(2):
        host = made.trial.markers.positions_m[:, int(rng.integers(len(names)))]
        drift = np.linspace(-0.05, 0.05, frames)[:, None] * rng.normal(size=3)
        ghost = host + 0.06 * rng.normal(size=3) + drift
        ghost[: frames // 4] = np.nan
        columns.append(ghost)
        labels.append(f"*{len(labels)}")
    markers = made.trial.markers
    return Stairs(
        replace(made.trial, markers=replace(markers, names=tuple(labels), positions_m=np.stack(columns, 1))),
        replace(markers, names=tuple(names[k] for k in keep), positions_m=shown),
        scale(static, mass_kg=person.mass_kg),
        tuple(names[k] for j, k in enumerate(keep) if named[j]),
        tuple(names[k] for k in moved),
        tuple(names[k] for k in dropped),
    )
