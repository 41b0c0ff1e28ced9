"""The live labeller on the captures of the labelling table: frame by frame, nothing decided again."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.block import Frame
from mbkf.trial.labelling.score import LabelScore, score
from mbkf.trial.live.filter import LiveFilter
from mbkf.trial.live.labels import LiveLabels, live_body

_PERCENT = 100.0


def streamed(points_m: Array, truth: MarkerTrajectories, subject: Subject) -> LabelScore:
    """Score of points named one frame after the other, with a kinematic filter.

    Args:
        points_m: (T, C, 3) points, m.
        truth: The true labels.
        subject: The scaled person.
    """
    body = live_body(subject)
    tracking = live_body(subject).tracking_filter(1.0 / truth.rate_hz)
    labels, live = LiveLabels(body, tracking.dt_s, patient=True), LiveFilter(tracking)
    named: list[Array] = []
    with single_threaded():
        for number, frame in enumerate(points_m):
            for markers in labels.push(frame, live.predict()):
                steps = live.push(len(named), Frame(markers, np.zeros((0, 6))))
                named.append(markers)
                last = steps[-1] if steps else None
                if last is not None and last.number == number and last.estimate is not None:
                    labels.learn(last.estimate.q)
    named += labels.finish()
    return score(replace(truth, names=body.names, positions_m=np.array(named)), truth, subject)


def live_rows(name: str, found: LabelScore, after: slice = slice(None), *, bounded: bool) -> list[Check]:
    """Right and wrong samples of the live labeller.

    Args:
        name: Beginning of the rows' names.
        found: The labeller's score.
        after: Frames that count.
        bounded: Whether the bounds of the offline labels apply.
    """
    present = max(1, int((found.right | found.missed)[after].sum()))
    right = _PERCENT * float(found.right[after].sum()) / present
    wrong = _PERCENT * float(found.wrong[after].sum()) / present
    return [
        Check(f"{name}, live: right", right, 99.8 if bounded else math.inf, ">=" if bounded else "<=", "%"),
        Check(f"{name}, live: wrong", wrong, 0.0 if bounded else math.inf, "<=", "%"),
    ]
