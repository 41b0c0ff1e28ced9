"""A session as it is reported: its trials, the gait of each kind, jumps and squats."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mbkf.conventions import Array
from mbkf.io.session import TrialKind
from mbkf.io.subject import Subject
from mbkf.io.visit import Visit
from mbkf.study.session.agreement import Disagreement
from mbkf.study.session.cycles import SideCycles
from mbkf.trial.emg.settings import EmgSettings
from mbkf.trial.gait.convention import BY_MODEL, MODEL, Convention


@dataclass(frozen=True)
class TrialEmg:
    """Electromyograms of a trial in short.

    Attributes:
        peaks_v: Largest envelope of each muscle, V.
        settings: Filters.
        rate_hz: Sample rate.
    """

    peaks_v: Mapping[str, float]
    settings: EmgSettings
    rate_hz: float


@dataclass(frozen=True)
class SessionTrial:
    """A trial of a session.

    Attributes:
        name: Its name.
        kind: Its kind.
        seconds: Duration.
        verdict: "use", "look" or "do not use".
        remarks: The reasons of the verdict, gravest first, then the trial's remarks.
        filter: The filter, and which later frames it knew.
        left_out: Parts that the capture shows and that may not be used, in words; means and norms leave them out.
        emg: Its electromyograms; None without.
        condition: Condition of walking; empty where not stated.
    """

    name: str
    kind: TrialKind
    seconds: float
    verdict: str
    remarks: tuple[str, ...]
    filter: str
    left_out: str = ""
    emg: TrialEmg | None = None
    condition: str = ""


@dataclass(frozen=True)
class Measure:
    """A number of each cycle, jump or squat, for both sides or for the body.

    Attributes:
        name: E.g. "Speed".
        unit: Of the values.
        values: By "r" and "l", or "" for the body as a whole; each (N,).
        trials: The trial of each value, in the same way.
    """

    name: str
    unit: str
    values: Mapping[str, Array]
    trials: Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class MovementGroup:
    """The trials of a kind and a condition that have gait, together.

    Attributes:
        kind: Walk, run, or unknown.
        trials: Their names.
        sides: Cycles of the right and the left foot.
        measures: Spatiotemporal parameters.
        condition: Condition of walking; empty where not stated.
    """

    kind: TrialKind
    trials: tuple[str, ...]
    sides: tuple[SideCycles, SideCycles]
    measures: tuple[Measure, ...]
    condition: str = ""

    def measure(self, name: str) -> Measure | None:
        """A parameter by its name; None without it."""
        return next((one for one in self.measures if one.name == name), None)


@dataclass(frozen=True)
class Session:
    """A session of one person.

    Attributes:
        name: As it is shown.
        subject: The scaled person.
        trials: All trials that were reconstructed.
        gaits: Trials with gait cycles, by kind, then by condition: barefoot first, then as for
            :data:`mbkf.io.visit.CONDITIONS`.
        jumps: Measures of each jump; empty without.
        squats: Measures of each squat; empty without.
        sex, age: As stated; None: not stated.
        disagreements: Trials that disagree with the others about the person's body.
        convention: Axes and signs of the curves.
        axes: Axes that angles are read in, one for all trials as a rule: "model", "isb" or "pig".
        patient: Name or code of the person; empty where not stated.
        visit: Facts of the visit.
    """

    name: str
    subject: Subject
    trials: tuple[SessionTrial, ...]
    gaits: tuple[MovementGroup, ...]
    jumps: tuple[Measure, ...] = ()
    squats: tuple[Measure, ...] = ()
    sex: str | None = None
    age: float | None = None
    disagreements: tuple[Disagreement, ...] = ()
    convention: Convention = BY_MODEL
    axes: tuple[str, ...] = (MODEL,)
    patient: str = ""
    visit: Visit = field(default_factory=Visit)

    def gait(self, kind: TrialKind, condition: str = "") -> MovementGroup | None:
        """The gait of a kind in a condition; None: the session has no such gait.

        Args:
            kind: The kind.
            condition: The condition; gait without a stated one belongs to any, and an empty text to the first gait.
        """
        same = [one for one in self.gaits if one.kind == kind]
        found = [one for one in same if one.condition == condition] or [
            one for one in same if not one.condition
        ]
        return next(iter(found or ([] if condition else same)), None)
