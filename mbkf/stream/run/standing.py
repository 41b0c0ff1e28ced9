"""The beginning of a live run without a subject file: somebody stands still, and is scaled while the stream goes on."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, wait
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject, write_subject
from mbkf.model.protocol import Protocol
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.live.scaling import STILL_S, Stance, StillWatch, scale_standing, worn_markers
from mbkf.stream.receiving.reader import PAUSE_S, READ_S
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import Events
from mbkf.stream.run.low_latency import prompt
from mbkf.stream.run.report import LIVE_FILE, ReportFile
from mbkf.stream.run.resumed import ResumedSource
from mbkf.stream.source import FrameSource, SourceFrame, StreamDescription, plausible

SUBJECT_FILE = "subject.toml"

TELL_S, AGAIN_S = 5.0, 10.0
"""So often it is told what is waited for, and the same thing once more."""

REPORT_S = 0.5
"""So often live.json is brought up to date."""

SILENT_S = 1.0
"""A stream that says nothing for this long is told of."""

MOST_KEPT = 100
"""So many frames with names wait at most while the person is scaled: the filter has to catch up with them. Without
names none do, since finding names keeps frames waiting, too."""

NAMED = 4
"""So many missing markers are told by name."""


@dataclass(frozen=True)
class KnownPerson:
    """What is known of somebody who is to be scaled.

    Attributes:
        mass_kg: Body mass; by default what the plates carry.
        protocol: The markers worn; by default the protocol that the stream's names belong to.
    """

    mass_kg: float | None = None
    protocol: Protocol | None = None


@dataclass(frozen=True)
class ScaledPerson:
    """Somebody who was scaled from a stream.

    Attributes:
        subject: The person.
        source: The stream from the frame on that followed those of standing.
        told: How the subject came about, for live.json.
    """

    subject: Subject
    source: ResumedSource
    told: dict[str, Any]


class StandingStart:
    """Waits until somebody stands still, scales the person and hands the stream on.

    Attributes:
        stream: What the source says, once it is connected.
    """

    def __init__(
        self,
        source: FrameSource,
        source_name: str,
        known: KnownPerson,
        folder: Path,
        say: Callable[[str], None],
        progress: Callable[[float | None], None] | None = None,
    ) -> None:
        """Args: source, its name, what is known of the person, folder for the results, and whom to tell.

        `say` takes sentences; `progress` how much of the standing is done, 0 to 1, None where no frames come.
        """
        self._source, self._source_name, self._known = source, source_name, known
        self._folder, self._say, self._done = folder, say, progress or (lambda _: None)
        self._begin_s = time.perf_counter()
        self._events = Events()
        self._stance = Stance(0, 0, 0.0, None, False)
        self._why, self._refused, self._refused_s = "nobody is seen yet", "", -AGAIN_S
        self._told, self._told_s = "", self._begin_s
        self._heard_s = self._begin_s
        self._frames_in = self._attempts = self._left_out = 0
        self._kept: deque[SourceFrame] = deque()
        self._job: Future[Subject] | None = None
        self._job_begin_s = self._scaling_s = 0.0

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source; False where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most.

        Raises:
            InvalidInput: The source did not appear in time, or more has to be known of the person.
            MbkfError: It is not what it should be.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is None:
            return False
        if self._known.mass_kg is None and not found.plates:
            raise InvalidInput(
                "the stream has no force plates that could tell the body mass; give --mass KG, or --subject"
            )
        if not found.marker_names and self._known.protocol is None:
            raise InvalidInput(
                "the stream's points have no names; say which markers are worn with --protocol NAME, or give --subject"
            )
        self.stream = found
        self._prepare(found)
        return True

    def _prepare(self, stream: StreamDescription) -> None:
        self._names = worn_markers(stream.marker_names, self._known.protocol)
        self._columns = [stream.marker_names.index(name) for name in self._names]
        worn = len(self._names)
        if not stream.marker_names:
            assert self._known.protocol is not None
            worn = sum(marker.kind != "computed" for marker in self._known.protocol.markers)
        self._worn = worn
        self._watch = StillWatch(stream.rate_hz, worn, bool(stream.marker_names))
        self._stretch: deque[SourceFrame] = deque(maxlen=self._watch.wanted)
        self._most = MOST_KEPT if stream.marker_names else 0

    def find(self, stop: threading.Event, patience_s: float | None = None) -> ScaledPerson | None:
        """Reads the stream until somebody has been scaled; writes subject.toml. None where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most; the time that scaling takes does not count.

        Raises:
            InvalidInput: The source ended, or the time was over, before anybody was scaled.
            OSError: Nothing can be written to the folder.
        """
        report = ReportFile(self._folder / LIVE_FILE)
        self._say(f"stand still for {STILL_S:g} s, upright and in sight of the cameras")
        try:
            with single_threaded(), prompt():
                found = self._look(stop, patience_s, report)
        except InvalidInput as error:
            report.write(self._report("nobody scaled", ended_by=str(error)), last=True)
            raise
        if found is None:
            report.write(self._report("nobody scaled", ended_by="it was stopped"), last=True)
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
                wait([self._job], READ_S)
            else:
                self._read(stop)
            if self._job is not None and self._job.done():
                subject = self._heard(self._job)
                if subject is not None:
                    return self._scaled(subject)
            if self._job is None:
                self._tell()
                if patience_s is not None and now - begin_s - self._scaling_s > patience_s:
                    raise InvalidInput(f"nobody was scaled within {patience_s:.0f} s: {self._reason()}")
        return None

    def _read(self, stop: threading.Event) -> None:
        """Takes the next frame, whatever happens to the source.

        Raises:
            InvalidInput: There are no more, and nobody is being scaled.
        """
        try:
            frame = self._source.read(READ_S)
        except EOFError:
            if self._job is None:
                raise InvalidInput(f"the source ended before anybody was scaled: {self._reason()}") from None
            wait([self._job], READ_S)
            return
        except Exception as error:  # a stream must not end a run, whatever its library does
            self._note("source", f"the source failed ({type(error).__name__}: {error})")
            stop.wait(PAUSE_S)
            return
        for kind, what in self._source.news():
            self._note(kind, what)
        if frame is not None:
            self._frames_in += 1
            self._heard_s = time.perf_counter()
            self._take(frame)

    def _take(self, frame: SourceFrame) -> None:
        if self._job is not None:
            self._kept.append(frame)
            if not self._source.patient and len(self._kept) > self._most:
                self._kept.popleft()
                self._left_out += 1
            return
        points = self._points(frame)
        self._stance = self._watch.push(points)
        if self._stance.frames <= 1:
            self._stretch.clear()
        self._stretch.append(frame)
        seen = self._stance.seen >= self._watch.least
        self._done(min(self._stance.frames / self._watch.wanted, 1.0) if seen else 0.0)
        self._look_why(points)
        if self._stance.enough:
            self._begin()

    def _points(self, frame: SourceFrame) -> Array:
        """(M, 3) the worn markers of a frame, or (N, 3) its points; what cannot be is missing."""
        return plausible(frame.markers_m[self._columns] if self._names else frame.unlabelled_m)[0]

    def _look_why(self, points_m: Array) -> None:
        """Keeps in mind what kept the person from standing still."""
        stance = self._stance
        what = "markers are" if self._names else "points are"
        if stance.frames == 1 and stance.moved_m > 0.0:
            mover = "the points" if stance.mover is None else f"marker {self._names[stance.mover]}"
            self._why = f"{mover} moved {1e3 * stance.moved_m:.0f} mm"
        elif stance.seen < self._watch.least:
            unseen = np.flatnonzero(np.isnan(points_m).any(axis=1))
            missing = [self._names[k] for k in unseen] if self._names else []
            more = " …" if len(missing) > NAMED else ""
            names = f" (not {', '.join(missing[:NAMED])}{more})" if missing else ""
            self._why = (
                f"{stance.seen} of {self._worn} {what} seen{names}, at least {self._watch.least} are needed"
            )

    def _begin(self) -> None:
        """Scales from the frames of standing, beside the stream."""
        capture, known = self._capture(), self._known
        self._attempts += 1
        self._job_begin_s = time.perf_counter()
        self._told = ""
        stay = "" if self._names else ", which takes some seconds as points have no names: stay where you are"
        if self._job_begin_s - self._refused_s >= AGAIN_S:
            self._say(f"standing still; scaling from {capture.markers.frames} frames{stay} …")
        self._job = _beside(
            lambda: scale_standing(capture, mass_kg=known.mass_kg, protocol=known.protocol), "scaling"
        )

    def _capture(self) -> Capture:
        """The frames of standing as a capture."""
        frames = list(self._stretch)
        points = [plausible(f.markers_m if self._names else f.unlabelled_m)[0] for f in frames]
        names = self.stream.marker_names
        if not names:
            width = max(len(one) for one in points)
            names = tuple(f"*{k}" for k in range(width))
            points = [np.pad(one, ((0, width - len(one)), (0, 0)), constant_values=np.nan) for one in points]
        markers = MarkerTrajectories(names, np.array(points), self.stream.rate_hz)
        wrench = np.concatenate([frame.plates.wrench for frame in frames])
        plates = tuple(_with_readings(plate, wrench[:, k]) for k, plate in enumerate(self.stream.plates))
        return Capture(self.stream.trial, markers, plates)

    def _heard(self, job: Future[Subject]) -> Subject | None:
        """The subject, or None where scaling failed: then somebody has to stand still once more."""
        try:
            return job.result()
        except MbkfError as error:
            why = str(error)
        except Exception as error:  # whatever the frames were, the next ones may be better
            why = f"an unforeseen {type(error).__name__}: {error}"
        self._note("scaling", why)
        now = self._heard_s = time.perf_counter()
        self._scaling_s += now - self._job_begin_s
        if why != self._refused or now - self._refused_s >= AGAIN_S:
            self._say(f"scaling failed: {why}; stand still once more")
            self._refused, self._refused_s = why, now
        self._job = None
        self._kept.clear()
        self._stretch.clear()
        self._watch.restart()
        self._done(0.0)
        return None

    def _scaled(self, subject: Subject) -> ScaledPerson:
        seconds = time.perf_counter() - self._job_begin_s
        write_subject(subject, self._folder / SUBJECT_FILE)
        rms_mm = subject.report["marker_rms_mm"]
        mass_from = "--mass" if self._known.mass_kg is not None else "plates"
        first, last = self._stretch[0], self._stretch[-1]
        told = {
            **self._progress(),
            "subject": SUBJECT_FILE,
            "protocol": subject.protocol,
            "mass_kg": subject.mass_kg,
            "mass_from": mass_from,
            "frames": len(self._stretch),
            "first_frame": first.number,
            "last_frame": last.number,
            "marker_rms_mm": rms_mm,
            "converged": subject.report["converged"],
            "waited_s": self._job_begin_s - self._begin_s,
            "scaling_s": seconds,
            "frames_kept_waiting": len(self._kept),
            "frames_left_out": self._left_out,
            "events": self._events.plain(),
        }
        weight = f"{subject.mass_kg:.1f} kg{' by the plates' if mass_from == 'plates' else ''}"
        self._say(
            f"scaled in {seconds:.1f} s: protocol {subject.protocol}, {weight}, markers fit to {rms_mm:.1f} mm RMS; "
            f"{self._folder / SUBJECT_FILE}"
        )
        return ScaledPerson(subject, ResumedSource(self._source, self.stream, self._kept), told)

    def _reason(self) -> str:
        return f"{self._why}; scaling failed: {self._refused}" if self._refused else self._why

    def _tell(self) -> None:
        """Says what is waited for, now and then."""
        now = time.perf_counter()
        silent = now - self._heard_s > SILENT_S
        if silent:
            self._done(None)
        why = "the stream says nothing" if silent else self._why
        if now - self._told_s >= (AGAIN_S if why == self._told else TELL_S):
            self._say(f"waiting for somebody to stand still: {why}")
            self._note("waiting", why)
            self._told, self._told_s = why, now

    def _note(self, kind: str, what: str) -> None:
        self._events.note(kind, what, time.perf_counter() - self._begin_s)

    def _progress(self) -> dict[str, Any]:
        return {"attempts": self._attempts, "frames_in": self._frames_in}

    def _report(self, state: str, **more: Any) -> dict[str, Any]:
        return {
            "state": state,
            "source": self._source_name,
            "trial": self.stream.trial,
            "nominal_rate_hz": self.stream.rate_hz,
            "scaling": {**self._progress(), "waiting_for": self._reason()},
            **more,
            "events": self._events.plain(),
        }


def _beside(work: Callable[[], Subject], name: str) -> Future[Subject]:
    """Work in a thread of its own, which does not keep the process alive when nobody waits for it any more."""
    future: Future[Subject] = Future()

    def run() -> None:
        try:
            future.set_result(work())
        except BaseException as error:  # whoever waits for it is told
            future.set_exception(error)

    threading.Thread(target=run, name=f"mbkf-{name}", daemon=True).start()
    return future


def _with_readings(plate: PlateReadings, wrench: Array) -> PlateReadings:
    """A plate with readings (S, 6), force N and moment N m about its own origin."""
    unknown = np.full((len(wrench), 3), np.nan)
    return replace(plate, force_n=wrench[:, :3], moment_nm=wrench[:, 3:], centre_of_pressure_m=unknown)
