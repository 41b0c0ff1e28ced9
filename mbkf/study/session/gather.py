"""A session put together from the folders of its results, one trial after the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import MOTION_FILE, read_reconstruction
from mbkf.io.session import SessionNotes, TrialKind, TrialNotes
from mbkf.io.session import session_of as session_of_entries
from mbkf.io.subject import Subject
from mbkf.io.verdict import listed
from mbkf.io.visit import CONDITIONS
from mbkf.model.human import HumanModel
from mbkf.study.batch.inputs import RECORD, read_record
from mbkf.study.session.agreement import TrialBody, disagreements
from mbkf.study.session.cycles import SideCycles, cycles_of_trial, together
from mbkf.study.session.emg import trial_emg, with_emg
from mbkf.study.session.jumps import jump_measures
from mbkf.study.session.records import Measure, MovementGroup, Session, SessionTrial
from mbkf.study.session.squats import squat_measures
from mbkf.study.survey.movement import SUNK_M, kind_of_markers
from mbkf.trial.gait.convention import Convention, convention_of_result
from mbkf.trial.gait.convention_angles import convention_angles
from mbkf.trial.gait.cycles import STRAIGHT_DEG, Gait, find_gait
from mbkf.trial.verdict.judge import verdict_of
from mbkf.trial.verdict.parts import LEGS, PELVIS
from mbkf.trial.verdict.restated import unstated

GAIT_KINDS = (TrialKind.WALK, TrialKind.RUN, TrialKind.UNKNOWN)
"""Kinds whose cycles are looked at; feet of jumps and squats strike, too."""

MOST_DEEP = 3
"""Folders in folders in which results are looked for."""


@dataclass(frozen=True)
class _Part:
    """Contribution of one trial to its session; measures need that pelvis and legs may be used (``moves``)."""

    trial: SessionTrial
    subject: Subject
    body: TrialBody
    axes: str
    sides: tuple[SideCycles, SideCycles]
    gait: Gait | None
    moves: bool
    jumps: tuple[Measure, ...]
    squats: tuple[Measure, ...]


def results_in(folder: Path) -> list[Path]:
    """The folders with results in a folder, itself included, in order of their names.

    Raises:
        InvalidInput: The folder holds no result.
    """
    if (folder / MOTION_FILE).is_file():
        return [folder]
    found = [
        file.parent
        for deep in range(1, MOST_DEEP + 1)
        for file in folder.glob("*/" * deep + MOTION_FILE)
        if not any(part.startswith(".") for part in file.relative_to(folder).parts)
    ]
    if not found:
        raise InvalidInput(f"{folder}: no results are here; make them with mbkf reconstruct or mbkf batch")
    return sorted(found)


def session_from(
    folders: Sequence[Path],
    name: str,
    notes: SessionNotes | None = None,
    convention: Convention | None = None,
    straight: bool = False,
) -> Session:
    """Reads the results of a session.

    Args:
        folders: A folder with results for each trial.
        name: How the session is called.
        notes: Statements of the session file: kinds of trials, which are left out, and the person.
        convention: Axes and signs of curves; None: the one that the first trial was reconstructed with.
        straight: Leaves out the gait cycles in which the pelvis turns; each trial's remarks state their number.

    Raises:
        FileFormatError: A result is damaged.
        InvalidInput: No trial is left.
    """
    stated = notes or SessionNotes()
    read = ((read_reconstruction(folder), folder) for folder in folders)
    pairs = ((r, _with_events(stated.trial(r.trial), folder)) for r, folder in read)
    kept = ((r, trial) for r, trial in pairs if not trial.excluded)
    return _session(kept, name, stated, convention, straight)


def session_of(
    results: Iterable[Reconstruction],
    name: str,
    notes: SessionNotes | None = None,
    convention: Convention | None = None,
) -> Session:
    """The session of results; each is let go before the next one is asked for.

    Args:
        results: The trials.
        name: How the session is called.
        notes: Statements of the session file.
        convention: As for :func:`session_from`.

    Raises:
        InvalidInput: The session has no trial.
    """
    stated = notes or SessionNotes()
    return _session(((r, stated.trial(r.trial)) for r in results), name, stated, convention)


def _session(
    results: Iterable[tuple[Reconstruction, TrialNotes]],
    name: str,
    stated: SessionNotes,
    convention: Convention | None,
    straight: bool = False,
) -> Session:
    """The session of trials, each with its statements in the session file.

    Raises:
        InvalidInput: The session has no trial.
    """
    parts, seen = [], Counter[str]()
    for r, own in results:
        seen[r.trial] += 1
        convention = convention or convention_of_result(r)
        notes = replace(own, condition=own.condition or stated.visit.condition)
        one = r if seen[r.trial] == 1 else _again(r, seen[r.trial])
        parts.append(_part(one, notes, convention, straight))
    if not parts or convention is None:
        raise InvalidInput(f"{name}: no trial to report on was found; reconstruct at least one trial first")
    return Session(
        name,
        parts[0].subject,
        tuple(part.trial for part in parts),
        _gaits(parts),
        _joined([part.jumps for part in parts]),
        _joined([part.squats for part in parts]),
        stated.sex or None,
        stated.age_at_visit,
        disagreements([part.body for part in parts]),
        convention,
        tuple(dict.fromkeys(part.axes for part in parts)),
        stated.name,
        stated.visit,
    )


def trial_summary(r: Reconstruction, kind: TrialKind | None = None) -> SessionTrial:
    """A trial in short.

    Args:
        r: Its results.
        kind: Kind of the trial; None: recognised from its markers.
    """
    verdict = verdict_of(r)
    out = [part for part in verdict.shown if not verdict.may_use(part)]
    if kind is None:
        kind = kind_of_result(r)
    seconds = r.frames / r.rate_hz
    return SessionTrial(
        r.trial,
        kind,
        seconds,
        verdict.overall,
        (*verdict.sentences, *unstated(r.warnings, verdict)),
        f"{r.filter}, {r.later_frames}",
        listed(out),
        trial_emg(r),
    )


def kind_of_result(r: Reconstruction) -> TrialKind:
    """Kind of movement of a trial with results: that of its markers, and sitting where a seat bore the pelvis.

    Args:
        r: Its results.
    """
    kind = kind_of_markers(MarkerTrajectories(r.marker_names, r.measured_m, r.rate_hz))
    if kind not in (TrialKind.SQUAT, TrialKind.UNKNOWN) or not r.tracked.any():
        return kind
    model = HumanModel.of(r.subject)
    bearings = model.description.bearings.items()
    seats = {name for name, one in bearings if one.segment == model.roles.root}
    sat = any(one.part in seats for one in r.contacts)
    rises = np.ptp(r.q[r.tracked, model.root.q.start + 2]) > SUNK_M
    return TrialKind.SIT_TO_STAND if sat and rises else kind


def _with_events(stated: TrialNotes, folder: Path) -> TrialNotes:
    """Statements about a trial, with the events by hand that its batch knew where the session file has none.

    Raises:
        FileFormatError: The batch's record is damaged.
    """
    record = folder / RECORD
    if stated.events is not None or not record.is_file():
        return stated
    known = read_record(record).get("events")
    if known is None:
        return stated
    return replace(
        stated, events=session_of_entries({"trial": {"x": {"event": known}}}, record).trial("x").events
    )


def _part(r: Reconstruction, stated: TrialNotes, convention: Convention, straight: bool) -> _Part:
    r = replace(r, verdict=verdict_of(r))
    trial = replace(trial_summary(r, stated.kind), condition=stated.condition)
    gait = find_gait(r, stated.events) if trial.kind in GAIT_KINDS and r.tracked.any() else None
    if straight and gait is not None:
        whole, gait = gait, find_gait(r, stated.events, straight=True)
        trial = replace(trial, remarks=(*trial.remarks, *_turned(whole, gait)))
    read = convention_angles(r, convention)
    right, left = (with_emg(r, cycles_of_trial(r, gait, side, convention, read)) for side in range(2))
    moves = all(verdict_of(r).may_use(part) for part in (PELVIS, *LEGS))
    return _Part(
        trial,
        r.subject,
        TrialBody.of(r),
        read.axes,
        (right, left),
        gait,
        moves,
        jump_measures(r) if trial.kind == TrialKind.JUMP and moves else (),
        squat_measures(r) if trial.kind == TrialKind.SQUAT and moves else (),
    )


def _turned(whole: Gait, straight: Gait | None) -> tuple[str, ...]:
    """A remark on the cycles that were left out."""
    count = len(whole.cycles)
    turned = count - (0 if straight is None else len(straight.cycles))
    text = (
        f"{turned} of {count} gait cycles left out: the pelvis turns by more than {STRAIGHT_DEG:.0f}° in them"
    )
    return (text,) if turned else ()


def _again(r: Reconstruction, number: int) -> Reconstruction:
    """A trial whose name was there before, under a name of its own."""
    return replace(r, trial=f"{r.trial} ({number})")


def _gaits(parts: Sequence[_Part]) -> tuple[MovementGroup, ...]:
    """The gait of each kind in each condition."""
    found = []
    for kind in GAIT_KINDS:
        with_gait = [part for part in parts if part.trial.kind == kind and part.gait is not None]
        conditions = dict.fromkeys(part.trial.condition for part in with_gait)
        found += [
            _group(kind, one, [part for part in with_gait if part.trial.condition == one])
            for one in sorted(conditions, key=_rank)
        ]
    return tuple(found)


def _rank(condition: str) -> int:
    """Place of a condition among others, which come last."""
    return CONDITIONS.index(condition) if condition in CONDITIONS else len(CONDITIONS)


def _group(kind: TrialKind, condition: str, parts: list[_Part]) -> MovementGroup:
    """Trials of a kind and a condition together."""
    sides = (together([p.sides[0] for p in parts], 0), together([p.sides[1] for p in parts], 1))
    names = tuple(p.trial.name for p in parts)
    return MovementGroup(kind, names, sides, _joined([_parameters(p) for p in parts if p.moves]), condition)


def _parameters(part: _Part) -> tuple[Measure, ...]:
    """Spatiotemporal parameters of one trial."""
    assert part.gait is not None
    name = part.trial.name
    return tuple(
        Measure(
            one.name,
            one.unit,
            dict(zip("rl", one.values, strict=True)),
            {side: (name,) * len(values) for side, values in zip("rl", one.values, strict=True)},
        )
        for one in part.gait.parameters
    )


def _joined(parts: Sequence[tuple[Measure, ...]]) -> tuple[Measure, ...]:
    """Measures of several trials together; those with flight and those without keep their own rows."""
    found: dict[str, list[Measure]] = {}
    for measures in parts:
        for one in measures:
            found.setdefault(one.name, []).append(one)
    return tuple(_one_measure(same) for same in found.values())


def _one_measure(same: list[Measure]) -> Measure:
    sides = list(dict.fromkeys(side for one in same for side in one.values))

    def each(values: Mapping[str, tuple[str, ...]], side: str) -> tuple[str, ...]:
        return values.get(side, ())

    return Measure(
        same[0].name,
        same[0].unit,
        {side: np.concatenate([one.values.get(side, np.empty(0)) for one in same]) for side in sides},
        {side: tuple(name for one in same for name in each(one.trials, side)) for side in sides},
    )
