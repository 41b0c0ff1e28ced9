"""Unexplained loads of a trial: the frames that they spoil, their sizes and times, and the likelier causes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.numerics.runs import runs
from mbkf.trial.loads.balance import LoadBalance
from mbkf.trial.loads.causes import Found, causes
from mbkf.trial.loads.flags import LIMITS, Contradictions
from mbkf.trial.loads.running import stated_frames

SPEED_SD_M_S, SCALE_SHARE = 0.03, 0.01
"""Standard deviations of the speed of the centre of mass from markers, and of plates' and body's weight. Clean trials
miss 0.3 to 1 % of body weight over a second."""


@dataclass(frozen=True)
class Unexplained:
    """Judgement of a trial.

    Attributes:
        force_n: (T, 3) mean force over half a second that acts besides weight and contacts; NaN where not judged.
        acts: (T,) frames in which an unexplained force acts: their loads are not to be used.
        loads: The stretches of these, in order of time.
    """

    force_n: Array
    acts: BoolArray
    loads: tuple[UnexplainedLoad, ...]


def unexplained_loads(
    balance: LoadBalance, times_s: Array, known: Sequence[UnexplainedLoad] = (), causal: bool = False
) -> Unexplained:
    """Forces that the contacts of a trial do not explain.

    Args:
        balance: Positions and contacts.
        times_s: (T,) times of the frames.
        known: Forces judged before; one at the same time keeps its cause.
        causal: The positions are those of a filter that knows no later frames, and lag behind in quick motion: a force
            is stated only where a live run states one, too.
    """
    trial = Contradictions(balance)
    half = trial.windows[-1]
    force_n = balance.course(half, trial.missing(half))
    if not trial.exceeded(trial.missing):
        return Unexplained(force_n, np.zeros(len(times_s), dtype=bool), ())
    stretches = _stretches(trial)
    if causal:
        late, stated = round(LIMITS[-1].duration_s * balance.rate_hz), stated_frames(balance)
        stretches = [(first, after) for first, after in stretches if stated[first : after + late].any()]
    acts = np.zeros(len(times_s), dtype=bool)
    for first, after in stretches:
        acts[first:after] = True
    course = balance.course(trial.edges, trial.missing(trial.edges))
    spans = [(float(times_s[first]), float(times_s[after - 1])) for first, after in stretches]
    before = [_known(known, span) for span in spans]
    found = causes(trial, stretches) if None in before else []
    loads = [
        _load(trial, course[first:after], span, cause or found[k])
        for k, ((first, after), span, cause) in enumerate(zip(stretches, spans, before, strict=True))
    ]
    return Unexplained(force_n, acts, tuple(loads))


def _stretches(trial: Contradictions) -> Sequence[tuple[int, int]]:
    """First frame and the frame after the last of each load: upward, downward, and horizontal beside these."""
    acting = trial.acting()
    vertical = [acting[2, 1], acting[2, -1]]
    level = np.zeros(len(trial.balance.judged), dtype=bool)
    for (axis, _), acts in acting.items():
        if axis != 2:
            level |= acts
    level &= ~(vertical[0] | vertical[1])
    return sorted(run for mask in (*vertical, level) for run in runs(mask))


def _known(known: Sequence[UnexplainedLoad], span_s: tuple[float, float]) -> Found | None:
    """The cause of the force judged before at a time, from when to when."""
    causes = [one for one in known if one.cause and one.from_s <= span_s[1] and one.to_s >= span_s[0]]
    if not causes:
        return None
    longest = max(causes, key=lambda one: min(one.to_s, span_s[1]) - max(one.from_s, span_s[0]))
    return Found(longest.cause, longest.hint)


def _load(trial: Contradictions, course: Array, span_s: tuple[float, float], found: Found) -> UnexplainedLoad:
    """A load.

    Args:
        trial: The trial.
        course: (n, 3) missing force of its frames.
        span_s: Times of its first and its last frame.
        found: Its cause.
    """
    vector, weight_n = np.nanmean(course, axis=0), trial.balance.weight_n
    lasting_s = max(span_s[1] - span_s[0], LIMITS[-1].duration_s)
    sd = float(np.hypot(np.sqrt(2.0) * SPEED_SD_M_S / (GRAVITY_M_S2 * lasting_s), SCALE_SHARE)) * weight_n
    x, y, z = (float(component) for component in vector)
    share = float(np.linalg.norm(vector)) / weight_n
    return UnexplainedLoad(*span_s, (x, y, z), sd, share, found.cause, found.hint)
