"""Whether frames come at the rate that their stream states, by this computer's clock."""

from __future__ import annotations

WATCHED_S = 2.0
"""The rate is measured over so long, and told when it is another one twice in a row: a pause is none."""

UNLIKE = 0.1
"""A rate that is off by more than this share is another one."""


class RateWatch:
    """Measures how fast frames come and how fast they count, over one stretch of time after the other."""

    def __init__(self, rate_hz: float) -> None:
        """Args: the rate that the stream states, Hz."""
        self._rate_hz = rate_hz
        self._begin: tuple[int, float] | None = None
        self._frames = 0
        self._unlike_before = False

    def unlike(self, number: int, arrival_s: float) -> float | None:
        """The measured rate, Hz, at the end of a stretch in which it was another, as in the one before; None else.

        Frames that come too fast are so by their arrivals, also where their count follows the clock. Those that come
        too slowly are so by their count: else they are lost ones.

        Args:
            number: Number of the frame.
            arrival_s: When it arrived.
        """
        if self._begin is None or number <= self._begin[0]:
            self._begin, self._frames = (number, arrival_s), 0
            return None
        self._frames += 1
        passed = arrival_s - self._begin[1]
        if passed < WATCHED_S:
            return None
        came, counted = self._frames / passed, (number - self._begin[0]) / passed
        self._begin, self._frames = (number, arrival_s), 0
        fast, slow = came > (1.0 + UNLIKE) * self._rate_hz, counted < (1.0 - UNLIKE) * self._rate_hz
        lasting, self._unlike_before = self._unlike_before, fast or slow
        return (came if fast else counted) if lasting and (fast or slow) else None
