"""The beginning of a live run without a subject file: a person stands still and is scaled while the stream goes on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import InvalidInput
from mbkf.io.subject import Subject, write_subject
from mbkf.model.protocol import Protocol
from mbkf.stream.receiving.reader import READ_S
from mbkf.stream.run.resumed import ResumedSource
from mbkf.stream.run.scaling_job import ScalingJob
from mbkf.stream.run.stance import StanceFrames
from mbkf.stream.run.still_start import STANDING, StillStart
from mbkf.stream.source import FrameSource, StreamDescription
from mbkf.trial.live.scaling import STILL_S, scale_standing

SUBJECT_FILE = "subject.toml"

MOST_KEPT = 100
"""Frames with names that wait at most while the person is scaled: the filter has to catch up with them. Without names
none do, since finding names keeps frames waiting, too."""


@dataclass(frozen=True)
class KnownPerson:
    """Facts of a person before scaling.

    Attributes:
        mass_kg: Body mass; None for the load of the plates.
        protocol: The marker set; None for the protocol that the stream's names belong to.
    """

    mass_kg: float | None = None
    protocol: Protocol | None = None


@dataclass(frozen=True)
class ScaledPerson:
    """A person scaled from a stream.

    Attributes:
        subject: The person.
        source: The stream, beginning at the frame after those of standing.
        report: Account of the scaling, for live.json.
    """

    subject: Subject
    source: ResumedSource
    report: dict[str, object]


class StandingStart(StillStart[ScaledPerson]):
    """Waits until a person stands still, scales the person and hands the stream on; writes subject.toml.

    The time that scaling takes does not count as waiting.
    """

    request = f"stand still for {STILL_S:g} s, upright and in sight of the cameras"
    failed_state = "no subject scaled"
    goal = "a person was scaled"

    def __init__(
        self,
        source: FrameSource,
        source_name: str,
        known: KnownPerson,
        folder: Path,
        say: Callable[[str], None],
        progress: Callable[[float | None], None] | None = None,
    ) -> None:
        """A start that is not connected yet.

        Args:
            source: The source of frames.
            source_name: Name of the source, for messages and live.json.
            known: Facts of the person.
            folder: For the results.
            say: Takes sentences for the person.
            progress: Takes the share of the standing that is over, 0 to 1; None where no frames come.
        """
        super().__init__(source, source_name, folder, say)
        self._known, self._progress = known, progress or (lambda _: None)
        self._attempts = self._left_out = 0
        self._job: ScalingJob | None = None

    def _begin(self, stream: StreamDescription) -> None:
        """Prepares for the stream.

        Raises:
            InvalidInput: Mass or protocol have to be given.
        """
        if self._known.mass_kg is None and not stream.plates:
            raise InvalidInput(
                "the stream has no force plates to weigh the person; give --mass KG, or --subject"
            )
        if not stream.marker_names and self._known.protocol is None:
            raise InvalidInput(
                "the stream's points have no names; give the marker set with --protocol NAME, or give --subject"
            )
        self._stance = StanceFrames(stream, self._known.protocol)

    def _step(self, stop: threading.Event) -> ScaledPerson | None:
        job = self._job
        if job is not None and self._source.patient:
            job.wait(READ_S)
        else:
            self._take(stop)
        if job is None or not job.done:
            return None
        outcome = job.outcome()
        if isinstance(outcome, Subject):
            return self._scaled(outcome, job)
        self._failed(outcome, job)
        return None

    def _take(self, stop: threading.Event) -> None:
        """Takes the next frame; those that come while the person is scaled are kept.

        Raises:
            InvalidInput: The source has ended, and no attempt to scale is under way.
        """
        try:
            frame = self._read(stop)
        except EOFError:
            if self._job is None:
                raise self._ended() from None
            self._job.wait(READ_S)
            return
        if frame is not None and self._job is not None:
            self._job.keep(frame)
        elif frame is not None:
            self._stance.push(frame)
            self._progress(self._stance.progress)
            if self._stance.enough:
                self._job = self._scaling()

    def _scaling(self) -> ScalingJob:
        """Scales from the frames of standing, beside the stream."""
        capture, known = self._stance.capture(), self._known
        self._attempts += 1
        most = None if self._source.patient else MOST_KEPT if self._stance.named else 0
        self._prompting.scaling(capture.markers.frames, self._stance.named)
        return ScalingJob(
            lambda: scale_standing(capture, mass_kg=known.mass_kg, protocol=known.protocol), most
        )

    def _failed(self, why: str, job: ScalingJob) -> None:
        """After a failed attempt the person has to stand still once more."""
        self._heard_s = time.perf_counter()
        self._uncounted_s += self._heard_s - job.begin_s
        self._left_out += job.left_out
        self._prompting.failed(why)
        self._job = None
        self._stance.restart()
        self._progress(0.0)

    def _scaled(self, subject: Subject, job: ScalingJob) -> ScaledPerson:
        seconds = time.perf_counter() - job.begin_s
        write_subject(subject, self._folder / SUBJECT_FILE)
        rms_mm = subject.report["marker_rms_mm"]
        mass_from = "--mass" if self._known.mass_kg is not None else "plates"
        report = {
            **self._counts(),
            "subject": SUBJECT_FILE,
            "protocol": subject.protocol,
            "mass_kg": subject.mass_kg,
            "mass_from": mass_from,
            "frames": len(self._stance),
            "first_frame": self._stance.first_number,
            "last_frame": self._stance.last_number,
            "marker_rms_mm": rms_mm,
            "converged": subject.report["converged"],
            "waited_s": job.begin_s - self._events.begin_s,
            "scaling_s": seconds,
            "frames_kept_waiting": len(job.kept),
            "frames_left_out": self._left_out + job.left_out,
            "events": self._events.plain(),
        }
        weight = f"{subject.mass_kg:.1f} kg{' by the plates' if mass_from == 'plates' else ''}"
        self._prompting.say(
            f"scaled in {seconds:.1f} s: protocol {subject.protocol}, {weight}, markers fit to {rms_mm:.1f} mm RMS; "
            f"{self._folder / SUBJECT_FILE}"
        )
        return ScaledPerson(subject, ResumedSource(self._source, self.stream, job.kept), report)

    def _reason(self) -> str:
        why, refused = self._stance.hindrance, self._prompting.refused
        return f"{why}; scaling failed: {refused}" if refused else why

    def _hindrance(self) -> str:
        return self._stance.hindrance

    def _state(self) -> str:
        return STANDING if self._job is None else "scaling"

    def _silent(self) -> None:
        self._progress(None)

    def _counts(self) -> dict[str, object]:
        return {"attempts": self._attempts, "frames_in": self._frames_in}

    def _progress_report(self) -> dict[str, object]:
        return {"scaling": {**self._counts(), "waiting_for": self._reason()}}
