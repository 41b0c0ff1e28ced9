"""The pieces of a trial: which frames are computed together, and which of these count."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

LONG_FRAMES = 30_000
"""A trial of more frames is reconstructed in pieces: five minutes at 100 Hz."""


@dataclass(frozen=True)
class PieceSettings:
    """Lengths of pieces.

    Attributes:
        frames: Frames of a piece.
        margin_s: Time on both sides of a piece that is computed with it and left out, so that filters over time and
            stretches of contact are whole at its borders.
        look_frames: Frames, spread over the trial, by which names, marker positions and axes are decided.
    """

    frames: int = 2000
    margin_s: float = 1.0
    look_frames: int = 6000


@dataclass(frozen=True)
class Piece:
    """A piece of a trial, with its margins.

    Attributes:
        first, after: Its first frame, and the one after its last.
        begin, end: The same with the margins.
    """

    first: int
    after: int
    begin: int
    end: int

    @property
    def inner(self) -> slice:
        """The piece's own frames among those with margins."""
        return slice(self.first - self.begin, self.after - self.begin)

    @property
    def whole(self) -> slice:
        """The frames with margins, in the trial."""
        return slice(self.begin, self.end)

    @property
    def own(self) -> slice:
        """The piece's own frames in the trial."""
        return slice(self.first, self.after)


def pieces_of(frames: int, rate_hz: float, settings: PieceSettings) -> Iterator[Piece]:
    """The pieces of a trial, in order.

    Args:
        frames: Frames of the trial.
        rate_hz: Frame rate.
        settings: Lengths of the pieces.
    """
    margin = round(settings.margin_s * rate_hz)
    for first in range(0, frames, settings.frames):
        after = min(first + settings.frames, frames)
        yield Piece(first, after, max(first - margin, 0), min(after + margin, frames))
