"""Scaling in a thread of its own while the stream goes on; frames that come meanwhile are kept."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, wait

from mbkf.errors import MbkfError
from mbkf.io.subject import Subject
from mbkf.stream.source import SourceFrame


class ScalingJob:
    """One attempt to scale a person.

    Attributes:
        begin_s: Start of the attempt on the clock of ``time.perf_counter``.
        kept: Frames that came since, oldest first.
        left_out: Frames that came since and found no place.
    """

    def __init__(self, scale: Callable[[], Subject], most_kept: int | None) -> None:
        """Begins at once; ``most_kept`` frames are kept at most, the latest ones, None for all."""
        self.begin_s = time.perf_counter()
        self.kept: deque[SourceFrame] = deque(maxlen=most_kept)
        self.left_out = 0
        self._result = _in_thread(scale, "mbkf-scaling")

    @property
    def done(self) -> bool:
        """True once the attempt has ended."""
        return self._result.done()

    def wait(self, timeout_s: float) -> None:
        """Waits for the end, but no longer than the given time."""
        wait([self._result], timeout_s)

    def keep(self, frame: SourceFrame) -> None:
        """Keeps a frame for the tracking that follows."""
        if self.kept.maxlen is not None and len(self.kept) == self.kept.maxlen:
            self.left_out += 1
        self.kept.append(frame)

    def outcome(self) -> Subject | str:
        """The scaled person, or the reason of a failure; only when done."""
        try:
            return self._result.result()
        except MbkfError as error:
            return str(error)
        except Exception as error:  # an unforeseen failure ends this attempt only
            return f"an unforeseen {type(error).__name__}: {error}"


def _in_thread(work: Callable[[], Subject], name: str) -> Future[Subject]:
    """Runs work in a daemon thread, which does not keep the process alive after the run has been stopped."""
    future: Future[Subject] = Future()

    def run() -> None:
        try:
            future.set_result(work())
        except BaseException as error:  # raised again where the result is asked for
            future.set_exception(error)

    threading.Thread(target=run, name=name, daemon=True).start()
    return future
