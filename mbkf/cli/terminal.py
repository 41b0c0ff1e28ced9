"""The door of all output to a terminal: letters that steer it, from files and their names, are shown as their codes.

Texts pass it by ``print``, errors, warnings and threads' tracebacks alike, since it stands in the place of
``sys.stdout`` and ``sys.stderr``. Colours of mbkf come from :func:`console` alone. Letters that the terminal's encoding
lacks are shown as codes, too. A code is written as JSON writes it, so that JSON stays JSON.
"""

from __future__ import annotations

import codecs
import io
import re
import sys
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.console import Console

PIPED_WIDTH = 110
"""Characters of a line where the output is no terminal."""

STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""Control letters but newline and tab, those that turn the direction of writing, and halves of letters."""

_CODES = "mbkf codes"


def visible(text: str) -> str:
    """A text with the letters of :data:`STEERING` as their codes."""
    return STEERING.sub(lambda found: _code(found[0]), text)


def _code(letter: str) -> str:
    units = letter.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i] << 8 | units[i + 1]:04x}" for i in range(0, len(units), 2))


def _as_codes(error: UnicodeError) -> tuple[str, int]:
    """Handler of letters that an encoding lacks."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_code, error.object[error.start : error.end])), error.end


codecs.register_error(_CODES, _as_codes)


class Guarded(io.TextIOBase):
    """A stream whose texts pass :func:`visible`.

    Attributes:
        stream: The stream below.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Writes a text; returns its length."""
        self.stream.write(visible(text))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:  # type: ignore[override]
        """Writes texts."""
        for line in lines:
            self.write(line)

    def flush(self) -> None:
        """Hands everything on."""
        self.stream.flush()

    def close(self) -> None:
        """Leaves the stream below open."""

    def fileno(self) -> int:
        """Number of the open file."""
        return self.stream.fileno()

    def isatty(self) -> bool:
        """True for a terminal."""
        return self.stream.isatty()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """Encoding of the stream below."""
        return self.stream.encoding

    @property
    def buffer(self) -> object:
        """The bytes below, for content that is no text."""
        return self.stream.buffer


@contextmanager
def guarded_output() -> Iterator[None]:
    """Puts the door in the place of ``sys.stdout`` and ``sys.stderr``."""
    before = sys.stdout, sys.stderr
    errors = [_encoded_as_codes(stream) for stream in before]
    sys.stdout, sys.stderr = (Guarded(stream) for stream in before)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before
        for stream, kind in zip(before, errors, strict=True):
            if kind is not None and isinstance(stream, io.TextIOWrapper) and not stream.closed:
                stream.reconfigure(errors=kind)


def show_traceback(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Writes an error with its traceback to the standard error.

    Args:
        kind: Class of the error.
        error: The error.
        trace: Its traceback.
    """
    with guarded_output():
        sys.stderr.write("".join(traceback.format_exception(kind, error, trace)))


def console(*, stderr: bool = False) -> Console:
    """A console that prints text as it is, with mbkf's colours on a terminal.

    Args:
        stderr: Print on the standard error.
    """
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.segment import Segment

    class Door(Console):
        """Passes on texts as :func:`visible` makes them, and colours as they are."""

        def render(
            self, renderable: RenderableType, options: ConsoleOptions | None = None
        ) -> Iterable[Segment]:
            for one in super().render(renderable, options):
                yield one if one.control else Segment(visible(one.text), one.style)

    stream = sys.stderr if stderr else sys.stdout
    below = stream.stream if isinstance(stream, Guarded) else stream
    terminal = below.isatty()
    width = None if terminal or stderr else PIPED_WIDTH
    return Door(file=below, highlight=False, markup=False, emoji=False, width=width)


def _encoded_as_codes(stream: TextIO) -> str | None:
    """Lets a stream write codes for letters that its encoding lacks; returns its way before, if it was changed."""
    if not isinstance(stream, io.TextIOWrapper):
        return None
    before = stream.errors
    stream.reconfigure(errors=_CODES)
    return before
