"""How a damaged file has to be refused: by the program's own error, in one short line, without a warning."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from mbkf.errors import MOST_LETTERS, MbkfError

MOST_BYTES = 4096
"""Size of the largest case."""


def refusal(read: Callable[[Path], object], path: Path, content: bytes | None) -> str:
    """The text with which a reader refuses a file.

    Args:
        read: The reader.
        path: The file.
        content: What is in it; None for a folder in its place.
    """
    if content is None:
        path.mkdir()
    else:
        assert len(content) <= MOST_BYTES
        path.write_bytes(content)
    with warnings.catch_warnings(), pytest.raises(MbkfError) as caught:
        warnings.simplefilter("error")
        read(path)
    text = str(caught.value)
    assert path.name in text and "\n" not in text and len(text) <= MOST_LETTERS + 10
    return text
