"""A live frame as the numbers people use: clinical angles and moments with their spreads, and the reactions."""

from __future__ import annotations

import threading

import numpy as np

from mbkf.conventions import SIDES, Array, read_only
from mbkf.io.dimensions import labels_of
from mbkf.io.results import PLOTTED
from mbkf.io.verdict import PARTS
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.stream.results.frame import LiveFrame

_LOAD = ("fx", "fy", "fz", "mx", "my", "mz")


HELD = 256
"""Frames that a receiver may lag behind; their rows are kept for it."""


class ResultValues:
    """Turns frames into rows of named numbers, one after another; receivers that share it compute each row once.

    Angles in rad (the pelvis's translations in m), moments in N m (N), reactions in N and N m about the world's origin,
    z up. ``…_sd_offset`` is the part of a standard deviation that repeats whenever the posture is the same. Then stand
    declared estimates (:data:`mbkf.io.results.PLOTTED`) in their own units, and ``unexplained``: 1 while an unexplained
    force is stated, so that moments and reactions are not to be used. Last stand ``valid``, 1 in frames whose moments
    and reactions may be used, and the running verdict: ``verdict`` and ``verdict_`` with each part, 0 for "use", 1 for
    "look", 2 for "do not use", NaN before it is known.

    Attributes:
        names: Of the numbers.
        units: Their units.
    """

    def __init__(self, model: Body) -> None:
        self._clinical = ClinicalAngles(model)
        self._before: Array | None = None
        self._lock = threading.Lock()
        self._rows: dict[int, tuple[LiveFrame, Array]] = {}
        angles = self._clinical.names
        rad = ["rad" if turns else "m" for turns in self._clinical.rotational]
        nm = ["N m" if turns else "N" for turns in self._clinical.rotational]
        loads = [f"reaction_{side}_{part}" for side in SIDES for part in _LOAD]
        newton = ["N", "N", "N", "N m", "N m", "N m"] * 2
        groups = [
            (angles, rad),
            ([f"{name}_sd" for name in angles], rad),
            ([f"{name}_moment" for name in angles], nm),
            ([f"{name}_moment_sd" for name in angles], nm),
            (loads, newton),
            ([f"{name}_sd" for name in loads], newton),
            ([f"{name}_sd_offset" for name in angles], rad),
            ([f"{name}_moment_sd_offset" for name in angles], nm),
            ([f"{name}_sd_offset" for name in loads], newton),
        ]
        self._widths = {}
        for name, one in PLOTTED.items():
            columns = [
                "_".join([name, *of.values()]) for of in labels_of(one.axes[1:], {"coordinate": angles})
            ]
            groups.append((columns, [one.unit.text] * len(columns)))
            self._widths[name] = len(columns)
        judged = ["unexplained", "valid", "verdict", *(f"verdict_{part}" for part in PARTS)]
        groups.append((judged, ["1"] * len(judged)))
        self.names: tuple[str, ...] = tuple(name for names, _ in groups for name in names)
        self.units: tuple[str, ...] = tuple(unit for _, units in groups for unit in units)

    def row(self, frame: LiveFrame) -> Array:
        """(len(names),) the numbers of a frame, NaN where the body is not tracked; not to be changed.

        Angles stay continuous with the row before.
        """
        with self._lock:
            if id(frame) not in self._rows:
                self._rows[id(frame)] = frame, self._computed(frame)
                if len(self._rows) > HELD:
                    del self._rows[next(iter(self._rows))]
            return self._rows[id(frame)][1]

    def _computed(self, frame: LiveFrame) -> Array:
        numbers = np.full((6, len(self._clinical.names)), np.nan)
        if np.isfinite(frame.q).all():
            q, clinical = frame.q[None], self._clinical
            angles = clinical.angles(q, self._before)
            self._before = angles[0]
            moments = clinical.moments(q, frame.torques[None], angles)[0]
            moments_sd = clinical.moments_sd(q, frame.torques_sd[None], angles)[0]
            moments_offset = clinical.moments_sd(q, frame.torques_offset[None], angles)[0]
            numbers[:] = angles[0], frame.angle_sd, moments, moments_sd, frame.angle_offset, moments_offset
        loads = frame.wrench.ravel(), frame.wrench_sd.ravel()
        unknown = {name: np.full(width, np.nan) for name, width in self._widths.items()}
        plotted = [np.ravel(values) for values in (unknown | dict(frame.plotted)).values()]
        words = (np.nan,) * (1 + len(PARTS)) if frame.judgement is None else frame.judgement.codes
        stated = np.array([frame.unexplained, frame.valid, *words], dtype=float)
        offsets = numbers[4:].ravel(), frame.wrench_offset.ravel()
        return read_only(np.concatenate([numbers[:4].ravel(), *loads, *offsets, *plotted, stated]))
