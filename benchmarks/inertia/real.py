"""Segments from plates of public captures: nothing is known of the truth, so what held-out halves say is shown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.captures import Person, load
from mbkf.errors import NotObservable
from mbkf.model.inertial_regressor import PER_OWN
from mbkf.numerics.threads import single_threaded
from mbkf.trial.inertia.estimate import estimate_from_rows, halves, lacking, rows_of
from mbkf.trial.inertia.prior import PLACE

CAPTURES = ("rajagopal walk", "rajagopal run", "gait2354", "biomechzoo HC032A", "biomechzoo HC044A")
"""Nothing was set on them."""


def real_rows(data: Path, quick: bool) -> list[Check]:
    """Evidence of each capture, and what plates lack in one half with segments that the other half told.

    Args:
        data: Folder of the public captures.
        quick: Whether only one capture is looked at.
    """
    rows = []
    for name in CAPTURES[: 1 if quick else None]:
        try:
            rows += _rows(name, load(name, data))
        except NotObservable:
            rows.append(information(f"{name}: shows enough", 0.0))
    return rows


def _rows(name: str, person: Person) -> list[Check]:
    subject = replace(person.subject, inertia={})
    regressor, rows = rows_of(subject, person.capture)
    with single_threaded():
        found = estimate_from_rows(subject, regressor, [rows], (name,))
    lacks = []
    for shown, hidden in (halves(rows), halves(rows)[::-1]):
        with single_threaded():
            own = estimate_from_rows(subject, regressor, [shown], (name,)).mean
        lacks.append([lacking(regressor, [hidden], x) for x in (np.zeros_like(own), own)])
    before, after = np.sqrt((np.array(lacks) ** 2).mean(axis=0))
    masses = found.mean[:-PLACE:PER_OWN]
    return [
        information(f"{name}: seconds that count", found.seconds, "s"),
        information(f"{name}: ln evidence ratio against the table", found.log_ratio, "nats"),
        information(f"{name}: the same of held-out halves", found.held_out_log_ratio, "nats"),
        information(f"{name}: written", float(found.supported)),
        information(f"{name}: force that plates lack in a half, table", before[0], "N"),
        information(f"{name}: … by the other half's segments / table", after[0] / before[0]),
        information(f"{name}: moment that plates lack in a half, table", before[1], "N m"),
        information(f"{name}: … by the other half's segments / table", after[1] / before[1]),
        information(f"{name}: masses' change, RMS", 100.0 * float(np.sqrt((masses**2).mean())), "%"),
    ]
