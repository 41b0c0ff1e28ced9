"""An mbkf command whose secrets carry a mark, so that they are found wherever they get to.

python -m benchmarks.misuse.marked_secrets ARGUMENTS...
"""

from __future__ import annotations

import itertools
import secrets
import sys

MARK = "M" + "arkedSecret"
"""The beginning of every secret of the command."""

FIRST = f"{MARK}0-"
"""The beginning of the first one: the token that opens the page for as long as it is served."""


def main() -> int:
    """Runs the command with marked secrets."""
    count, true = itertools.count(), secrets.token_urlsafe

    def marked(nbytes: int | None = None) -> str:
        return f"{MARK}{next(count)}-{true(nbytes)}"

    secrets.token_urlsafe = marked
    from mbkf.cli.main import main as command

    return command(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
