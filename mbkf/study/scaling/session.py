"""A person scaled from a session: standing, and those of the other trials that show the body well.

The standing trial is scaled first on a few frames. Its body judges the other trials
(:mod:`mbkf.study.scaling.excitation`), and the chosen ones are scaled with it together
(:mod:`mbkf.study.scaling.choice`). Where they do not fit one body, the standing trial alone counts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

from mbkf.conventions import StageCallback
from mbkf.errors import MbkfError
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.study.scaling.choice import Choice, Chosen, Part, choose
from mbkf.study.scaling.excitation import Excitation, StandingBody
from mbkf.study.scaling.report import as_report
from mbkf.study.scaling.rounds import rounds
from mbkf.trial.axes.captures import checked_for_subject

STANDING_FRAMES, MOVING_FRAMES = 5, 12
"""Frames of a standing or moving trial for the body that judges the others: of a standing one factors differ by 0.01 at
most from those of all frames."""

MOST_FRAMES = 48
"""Frames of all trials together, which bounds the time. With 60, errors of the legs' angles were 3.14° of the shared
persons and 3.53° of three made ones (obese, short legs, tilted pelvis); with 48, chosen on them, 3.12° and 3.47°. Shown
on child, amputee, long legs and broad shoulders with two kinds of skin: 2.87° and 3.39°, with 48 2.89° and 3.37°."""

MOST_MOVING = 3
"""Number of trials that are taken where there is no standing one, and no other shows a movement that helps."""

Scaling = Callable[..., Subject]
""":func:`mbkf.trial.scale.scale` with all arguments but captures, ``settings`` and ``progress``."""


@dataclass(frozen=True)
class SessionTrial:
    """A trial of a session.

    Attributes:
        name: Its name.
        read: Reads it; raises an error of mbkf where that fails.
    """

    name: str
    read: Callable[[], Capture]


@dataclass(frozen=True)
class SessionScaling:
    """A person scaled from a session.

    Attributes:
        subject: The person; the report names the trials used and left out.
        captures: The standing trial and the chosen ones.
    """

    subject: Subject
    captures: tuple[Capture, ...]


def scale_from_session(
    static: SessionTrial,
    trials: Sequence[SessionTrial],
    scaling: Scaling,
    settings: ScalingSettings | None = None,
    progress: StageCallback | None = None,
) -> SessionScaling:
    """Scales a person from a standing trial and the trials of the session that help.

    Args:
        static: The standing trial.
        trials: The session's other trials, each with a name of its own. They are looked at in rounds
            (:mod:`mbkf.study.scaling.rounds`) until a walk and a deep flexion are found.
        scaling: Scales the person from captures.
        settings: Weights of the priors; of several trials fewer frames are taken than they say.
        progress: Called with the stage, items done and items in all.

    Raises:
        MbkfError: The standing trial cannot be read or scaled.
    """
    standing, settings = static.read(), settings or ScalingSettings()
    looked_at = chosen_trials(standing, trials, scaling, settings, progress)
    choice, subject = looked_at.choice, None
    captures = {name: looked_at.captures[name] for name in choice.names}
    if captures:
        fewer = _fewer_frames(settings, 1 + len(captures))
        try:
            subject = scaling(standing, list(captures.values()), settings=fewer, progress=progress)
            why = new_doubts(subject, looked_at.standing)
        except MbkfError as error:
            why = str(error)
        if why:
            why = f"together with standing it fits no likely body: {why}"
            choice = Choice((), {**choice.left_out, **dict.fromkeys(captures, why)})
            subject, captures = None, {}
    subject = subject or scaling(standing, [], settings=settings, progress=progress)
    report = {**subject.report, **as_report(static.name, choice)}
    return SessionScaling(replace(subject, report=report), (standing, *captures.values()))


def scale_from_moving(
    trials: Sequence[SessionTrial],
    scaling: Scaling,
    settings: ScalingSettings | None = None,
    progress: StageCallback | None = None,
) -> SessionScaling:
    """Scales a person without a standing trial from the trials that help, or else from the first ones.

    The first trial that gives a body takes the place of standing: its body judges the others.

    Args:
        trials: The session's trials, each with a name of its own.
        scaling: Scales the person from captures.
        settings: Weights of the priors; of several trials fewer frames are taken than they say.
        progress: Called with the stage, items done and items in all.

    Raises:
        MbkfError: A trial cannot be read, or no trial gives a body.
    """
    settings = settings or ScalingSettings()
    by_name = {trial.name: trial for trial in trials}
    in_order = [name for one in rounds(tuple(by_name)) for name in one]
    looked_at = LookedAt(Choice())
    for name in in_order:
        try:
            quick = scaling(
                None, [by_name[name].read()], settings=replace(settings, frames_per_trial=MOVING_FRAMES)
            )
        except MbkfError:
            continue
        looked_at = _compared(by_name[name].read(), quick, trials, progress)
        break
    choice = looked_at.choice
    captures, subject = [looked_at.captures[name] for name in choice.names], None
    if captures:
        with suppress(MbkfError):
            subject = scaling(
                None, captures, settings=_fewer_frames(settings, len(captures)), progress=progress
            )
    if subject is None:
        choice = Choice(tuple(Chosen(name, Part.FIRST, "") for name in in_order[:MOST_MOVING]))
        captures = [by_name[name].read() for name in choice.names]
        subject = scaling(None, captures, settings=settings, progress=progress)
    return SessionScaling(
        replace(subject, report={**subject.report, **as_report("", choice)}), tuple(captures)
    )


def _fewer_frames(settings: ScalingSettings, trials: int) -> ScalingSettings:
    return replace(settings, frames_per_trial=min(settings.frames_per_trial, MOST_FRAMES // trials))


@dataclass(frozen=True)
class LookedAt:
    """Trials of a session that were looked at.

    Attributes:
        choice: Those that help, and the reasons of the others.
        captures: Captures by name, without plates.
        standing: The person scaled from a few frames of the trial that the others were compared with; None without one.
    """

    choice: Choice
    captures: Mapping[str, Capture] = field(default_factory=dict)
    standing: Subject | None = None


def chosen_trials(
    standing: Capture,
    trials: Sequence[SessionTrial],
    scaling: Scaling,
    settings: ScalingSettings,
    progress: StageCallback | None = None,
) -> LookedAt:
    """The trials of a session that help scaling.

    Args:
        standing: The standing trial.
        trials: The others.
        scaling: Scales the person from captures.
        settings: Weights of the priors.
        progress: Called with the stage, items done and items in all.
    """
    if not trials:
        return LookedAt(Choice())
    try:
        quick = scaling(standing, [], settings=replace(settings, frames_per_trial=STANDING_FRAMES))
        return _compared(standing, quick, trials, progress)
    except MbkfError as error:
        why = f"it cannot be compared with standing ({error})"
        return LookedAt(Choice((), {trial.name: why for trial in trials}))


def _compared(
    reference: Capture, quick: Subject, trials: Sequence[SessionTrial], progress: StageCallback | None
) -> LookedAt:
    """The trials that help, compared with a trial and the body that a few frames of it give.

    Raises:
        MbkfError: The axes of the trial contradict the body, or it shows too few markers.
    """
    body = StandingBody(quick, checked_for_subject(reference, quick).markers)
    report = progress or (lambda *_: None)
    captures, looked, refused = dict[str, Capture](), dict[str, Excitation](), dict[str, str]()
    choice = Choice()
    by_name = {trial.name: trial for trial in trials}
    in_rounds = rounds(tuple(by_name))
    count = sum(len(one) for one in in_rounds)
    for one in in_rounds:
        for name in one:
            report("Choosing trials", len(looked) + len(refused), count)
            try:
                with single_threaded():
                    capture = replace(by_name[name].read(), plates=())
                    looked[name] = body.excitation(checked_for_subject(capture, quick).markers)
                captures[name] = capture
            except (MbkfError, OSError) as error:
                refused[name] = str(error)
        choice = choose(looked, refused)
        if choice.complete:
            break
    report("Choosing trials", count, count)
    return LookedAt(choice, captures, quick)


def new_doubts(subject: Subject, standing: Subject | None) -> str:
    """Doubts about a body that its standing trial alone does not raise; "" without any.

    Args:
        subject: The person scaled from the session.
        standing: The person scaled from standing.
    """
    found = subject.report.get(DOUBTS_KEY)
    known = standing is not None and DOUBTS_KEY in standing.report
    return "" if known or not isinstance(found, list) else "; ".join(str(doubt) for doubt in found)
