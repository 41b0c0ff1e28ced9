"""Right trials that bounds of verdicts were not set on, and the judgement of a trial."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from benchmarks.foreign.making.persons import CHOSEN_ON, SHOWN_ON
from benchmarks.foreign.making.skin import MODELS
from benchmarks.loads.trials import Trial
from mbkf.errors import MbkfError
from mbkf.io.verdict import Word
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.verdict.judge import verdict_of

MOTIONS, SEEDS = ("walk", "jump", "step_up", "turn", "squat"), (3, 4, 5)
"""Synthetic trials that no bound was set on."""

MADE_MODEL, MADE_MOTIONS = MODELS[1], ("walk", "squat", "run")
"""Skin and motions of made persons that no bound was set on."""

WRONG_DEG, WRONG_NM_PER_KG = 10.0, 0.3
"""Errors from which a result is wrong: root mean square over frames in which it may be used."""


@dataclass(frozen=True)
class Judged:
    """Judgement of a trial.

    Attributes:
        label: The trial.
        word: The word of the whole trial; "refused" if `reconstruct` refuses the capture.
        angle_deg, torque_nm_per_kg: Largest error of a leg's sagittal angle or torque among results that may be used;
            NaN of a right trial.
        line: The verdict in a line.
    """

    label: str
    word: Word | str
    angle_deg: float
    torque_nm_per_kg: float
    line: str

    @property
    def wrong(self) -> bool:
        """True for a wrong result among those that may be used."""
        return self.angle_deg > WRONG_DEG or self.torque_nm_per_kg > WRONG_NM_PER_KG

    @property
    def wrong_in_use(self) -> bool:
        """True for a wrong result under "use"."""
        return self.word == "use" and self.wrong


def shown_right(data: Path, made: Path | None, quick: bool = False) -> list[Trial]:
    """Right trials.

    Args:
        data: Folder of the reference captures.
        made: Folder of persons made from OpenSim's bodies; None without them.
        quick: Every fifth of them.
    """
    found = [Trial("own", motion, data, seed) for motion in MOTIONS for seed in SEEDS]
    if made is not None:
        persons = [made / MADE_MODEL / person for person in (*CHOSEN_ON, *SHOWN_ON)]
        found += [Trial("foreign", motion, person) for person in persons for motion in MADE_MOTIONS]
    return found[::5] if quick else found


def judged(trial: Trial) -> Judged:
    """Reconstructs and judges a right trial.

    Args:
        trial: The trial.
    """
    nan = float("nan")
    with single_threaded():
        capture, subject, _ = trial.load()
        try:
            found = reconstruct(
                capture, subject, settings=ReconstructSettings(other_contacts=not trial.feet_only)
            )
        except MbkfError as error:
            return Judged(trial.label, "refused", nan, nan, str(error))
    verdict = verdict_of(found)
    return Judged(trial.label, verdict.overall, nan, nan, verdict.line)
