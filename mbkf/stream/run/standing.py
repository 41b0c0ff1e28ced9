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
from mbkf.numerics.threads import single_threaded
from mbkf.stream.receiving.reader import PAUSE_S, READ_S, SILENT_S
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.low_latency import low_latency
from mbkf.stream.run.prompting import Prompting
from mbkf.stream.run.report import LIVE_FILE, ReportFile
from mbkf.stream.run.resumed import ResumedSource
from mbkf.stream.run.scaling_job import ScalingJob
from mbkf.stream.run.stance import StanceFrames
from mbkf.stream.source import FrameSource, StreamDescription
from mbkf.trial.live.scaling import STILL_S, scale_standing

SUBJECT_FILE = "subject.toml"

REPORT_S = 0.5
"""Interval at which live.json is brought up to date."""

MOST_KEPT = 100
"""Frames with names that wait at most while the person is scaled: the filter has to catch up with them. Without names
none do, since finding names keeps frames waiting, too."""


@dataclass(frozen=True)
class KnownPerson:
    """What is known of a person before scaling.

    Attributes:
        mass_kg: Body mass; None for what the plates carry.
        protocol: The markers worn; None for the protocol that the stream's names belong to.
    """

    mass_kg: float | None = None
    protocol: Protocol | None = None


@dataclass(frozen=True)
class ScaledPerson:
    """A person scaled from a stream.

    Attributes:
        subject: The person.
        source: The stream, beginning at the frame after those of standing.
        report: How the subject was obtained, for live.json.
    """

    subject: Subject
    source: ResumedSource
    report: dict[str, object]


class StandingStart:
    """Waits until a person stands still, scales the person and hands the stream on.

    Attributes:
        stream: The stream's description, once the source is connected.
    """

    stream: StreamDescription

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
            source: Where frames come from.
            source_name: Name of the source, for messages and live.json.
            known: What is known of the person.
            folder: For the results.
            say: Takes sentences for the person.
            progress: Takes the share of the standing that is over, 0 to 1; None where no frames come.
        """
        self._source, self._source_name, self._known = source, source_name, known
        self._folder, self._progress = folder, progress or (lambda _: None)
        self._events = EventLog()
        self._prompting = Prompting(say, self._events)
        self._heard_s = self._events.begin_s
        self._frames_in = self._attempts = self._left_out = 0
        self._job: ScalingJob | None = None
        self._failed_s = 0.0

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source; False where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most; None for as long as it takes.

        Raises:
            InvalidInput: The source did not appear in time, or mass or protocol have to be given.
            MbkfError: The stream cannot be read.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is None:
            return False
        if self._known.mass_kg is None and not found.plates:
            raise InvalidInput(
                "the stream has no force plates to weigh the person; give --mass KG, or --subject"
            )
        if not found.marker_names and self._known.protocol is None:
            raise InvalidInput(
                "the stream's points have no names; give the markers worn with --protocol NAME, or give --subject"
            )
        self.stream = found
        self._stance = StanceFrames(found, self._known.protocol)
        return True

    def find(self, stop: threading.Event, patience_s: float | None = None) -> ScaledPerson | None:
        """Reads the stream until a person has been scaled; writes subject.toml. None where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most; the time that scaling takes does not count.

        Raises:
            InvalidInput: The source ended, or the time was over, before a person was scaled.
            OSError: Nothing can be written to the folder.
        """
        report = ReportFile(self._folder / LIVE_FILE)
        self._prompting.say(f"stand still for {STILL_S:g} s, upright and in sight of the cameras")
        try:
            with single_threaded(), low_latency():
                found = self._look(stop, patience_s, report)
        except InvalidInput as error:
            report.write(self._report("no subject scaled", ended_by=str(error)), last=True)
            raise
        if found is None:
            report.write(self._report("no subject scaled", ended_by="it was stopped"), last=True)
        return found

    def _look(
        self, stop: threading.Event, patience_s: float | None, report: ReportFile
    ) -> ScaledPerson | None:
        begin_s, written_s = time.perf_counter(), 0.0
        while not stop.is_set():
            now = time.perf_counter()
            if now - written_s >= REPORT_S:
                report.write(self._report("standing" if self._job is None else "scaling"))
                written_s = now
            if self._job is not None and self._source.patient:
                self._job.wait(READ_S)
            else:
                self._read(stop)
            if self._job is not None and self._job.done:
                outcome = self._job.outcome()
                if isinstance(outcome, Subject):
                    return self._scaled(outcome, self._job)
                self._failed(outcome, self._job)
            if self._job is None:
                self._say_reason()
                if patience_s is not None and now - begin_s - self._failed_s > patience_s:
                    raise InvalidInput(f"no person was scaled within {patience_s:.0f} s: {self._reason()}")
        return None

    def _read(self, stop: threading.Event) -> None:
        """Takes the next frame; an error of the source does not end the run.

        Raises:
            InvalidInput: The source has ended, and no person is being scaled.
        """
        try:
            frame = self._source.read(READ_S)
        except EOFError:
            if self._job is None:
                raise InvalidInput(f"the source ended before a person was scaled: {self._reason()}") from None
            self._job.wait(READ_S)
            return
        except Exception as error:  # libraries of sources raise errors of any kind
            self._events.note("source", f"the source failed ({type(error).__name__}: {error})")
            stop.wait(PAUSE_S)
            return
        for kind, what in self._source.news():
            self._events.note(kind, what)
        if frame is None:
            return
        self._frames_in += 1
        self._heard_s = time.perf_counter()
        if self._job is not None:
            self._job.keep(frame)
            return
        self._stance.push(frame)
        self._progress(self._stance.progress)
        if self._stance.enough:
            self._job = self._begin()

    def _begin(self) -> ScalingJob:
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
        self._failed_s += self._heard_s - job.begin_s
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

    def _say_reason(self) -> None:
        silent = time.perf_counter() - self._heard_s > SILENT_S
        if silent:
            self._progress(None)
        self._prompting.waiting("no frames come from the stream" if silent else self._stance.hindrance)

    def _counts(self) -> dict[str, object]:
        return {"attempts": self._attempts, "frames_in": self._frames_in}

    def _report(self, state: str, **more: object) -> dict[str, object]:
        return {
            "state": state,
            "source": self._source_name,
            "trial": self.stream.trial,
            "nominal_rate_hz": self.stream.rate_hz,
            "scaling": {**self._counts(), "waiting_for": self._reason()},
            **more,
            "events": self._events.plain(),
        }
