"""End of a run that cannot go on: the first error of a thread that it depends on."""

from __future__ import annotations

import threading


class Failure:
    """Takes errors from any thread; the first one is kept."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._cause: str | None = None

    @property
    def cause(self) -> str | None:
        """The failure in words; None while all goes well."""
        return self._cause

    def of(self, part: str, error: BaseException) -> None:
        """Notes that a part of the run has ended with an error."""
        with self._lock:
            if self._cause is None:
                self._cause = f"{part} failed: an unforeseen {type(error).__name__}: {error}"
