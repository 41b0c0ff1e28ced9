"""The verdict while a live run goes on: evidence of each answered frame, judged each second, noted as it changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mbkf.io.findings import Finding
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.subject import Subject
from mbkf.io.verdict import WORDS, Word
from mbkf.stream.receiving.alignment import Note
from mbkf.stream.results.judgement import Judgement
from mbkf.stream.run.checking import LiveChecks
from mbkf.stream.run.setup import LiveSetup
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.trial.live.running_evidence import RunningEvidence, with_causes
from mbkf.trial.loads.running import RunningLoad
from mbkf.trial.preparation.coverage import use_of_names
from mbkf.trial.verdict.evidence import Found

EVERY_S = 1.0
"""Time of frames before the first verdict, and between two; a limb in doubt and checks are judged at once."""


class VerdictWatch:
    """Judges a run frame by frame.

    Attributes:
        judgement: The judgement so far; None in the first second.
    """

    def __init__(
        self,
        setup: LiveSetup,
        subject: Subject,
        loads: LoadWatch,
        note: Note,
        checks: LiveChecks | None = None,
        put_doubt: Callable[[LimbDoubt], None] | None = None,
        notices: Callable[[], tuple[str, ...]] = tuple,
    ) -> None:
        """A watch that has seen no frame.

        Args:
            setup: The stream, its markers and the filter.
            subject: The person.
            loads: Unexplained loads of the run.
            note: Called with events: a new word, a limb in doubt.
            checks: Checks of the run in a process of their own.
            put_doubt: Takes doubts about limbs for the log.
            notices: Returns remarks on the stream.
        """
        self._filter, self._loads, self._note = setup.filter, loads, note
        self._checks, self._put_doubt, self._notices = checks, put_doubt, notices
        self._rate_hz = setup.stream.rate_hz
        self._evidence = RunningEvidence(setup.live, subject, self._rate_hz)
        self._explained = use_of_names(setup.stream.marker_names, subject).share
        self._due = round(EVERY_S * self._rate_hz)
        self._usable, self._broken = True, False
        self._judged_checks: Sequence[Finding] = () if checks is None else checks.findings
        self._noted: dict[tuple[str, float], bool] = {}
        self._logged = 0
        self._told: dict[str, Word] = {}
        self.judgement: Judgement | None = None

    def push(self, row: NDArray, load: RunningLoad) -> bool:
        """The next answered frame; True where its loads may be used, as far as is known by now.

        Args:
            row: (1,) the log's row of it.
            load: Judgement of the force that no contact explains.
        """
        if self._broken:
            return False
        watch = self._filter.loop.watch
        order = None if watch is None else watch.order
        try:
            with np.errstate(all="ignore"):  # a stream may hold nonsense
                if self._due_now:
                    self.judge()
                if row["started"][0] and self._evidence.frames and self._checks is not None:
                    self._checks.restarted(self._evidence.frames)
                known = self._evidence.push(row, self._loads.read, load.acts, order)
        except Exception as error:  # a recording goes on without its verdict
            self._failed(error)
            return False
        return known and self._usable and not load.acts

    @property
    def _due_now(self) -> bool:
        """True where a second has passed, or a limb was in doubt, or checks have an answer that is not judged yet."""
        answered = self._checks is not None and self._checks.findings is not self._judged_checks
        limb = self._filter.limb_doubts_ended > self._logged
        return answered or limb or self._evidence.frames >= self._due

    def judge(self, noting: bool = True) -> None:
        """Judges the frames so far; a new word on a part is noted while the run goes on."""
        frames = self._evidence.frames
        self._due = frames + max(1, round(EVERY_S * self._rate_hz))
        if self._checks is not None:
            self._judged_checks = self._checks.findings
            self._checks.reached(frames)
        limbs, checks = self._limbs(), tuple(self._judged_checks)
        loads = with_causes(self._loads.stated(), checks)
        found = Found(limbs, loads, (), checks, self._explained)
        verdict = self._evidence.verdict(found)
        before, now = self.judgement, Judgement(verdict, (frames - 1) / self._rate_hz, limbs, self._notices())
        if before is not None and replace(now, time_s=before.time_s) == before:
            return
        self._usable, self.judgement = verdict.loads_usable, now
        told, self._told = self._told, {part: verdict.parts[part] for part in verdict.shown}
        if noting and any(word != told.get(part, WORDS[0]) for part, word in self._told.items()):
            self._note("verdict", verdict.line, None, 1)

    def end(self) -> None:
        """Judges the last frames."""
        if self._broken or not self._evidence.frames:
            return
        try:
            with np.errstate(all="ignore"):
                self.judge(noting=False)
        except Exception as error:  # the results are still to be written
            self._failed(error)

    def _failed(self, error: Exception) -> None:
        self._broken, self.judgement = True, None
        what = f"the running verdict failed ({type(error).__name__}: {error}); the run is judged at its end"
        self._note("verdict", what, None, 1)

    def plain(self) -> dict[str, object]:
        """The judgement so far, for live.json."""
        now = self.judgement
        return (
            {}
            if now is None
            else {"verdict": now.verdict.as_table(), "limb_doubts": now.plain()["limb_doubts"]}
        )

    def _limbs(self) -> tuple[LimbDoubt, ...]:
        """Limbs in doubt so far; new ones are noted, and logged once they do not change any more."""
        found = self._filter.limb_doubts()
        for one in found:
            key, mended = (one.limb, one.from_s), one.mended
            if self._noted.get(key) != mended:
                self._noted[key] = mended
                self._note("limb", one.sentence, round(one.to_s * self._rate_hz), 1)
        ended = self._filter.limb_doubts_ended
        for one in found[self._logged : ended]:
            if self._put_doubt is not None:
                self._put_doubt(one)
        self._logged = ended
        return found
