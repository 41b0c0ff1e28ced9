"""Tables and text on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbkf.cli.terminal import console

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table


def terminal() -> Console:
    """A console that prints text as it is."""
    return console()


def table(title: str, *headings: str, words: int = 1) -> Table:
    """A table whose first columns hold words and whose others hold numbers.

    Args:
        title: Line above it; empty for no title.
        headings: Of the columns.
        words: Number of columns that are aligned left.
    """
    from rich.table import Table

    made = Table(title=title or None, title_justify="left")
    for k, heading in enumerate(headings):
        made.add_column(heading, justify="left" if k < words else "right")
    return made
