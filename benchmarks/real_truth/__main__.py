"""Writes the page of real truth from the reference captures."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.__main__ import DATA_VARIABLE
from benchmarks.checks import Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.real_truth import by_scaling
from benchmarks.real_truth.before import before_rows
from benchmarks.real_truth.followed import SCALINGS
from benchmarks.real_truth.page import write_page
from mbkf.errors import MbkfError


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the page.

    Args:
        arguments: What follows ``python -m benchmarks.real_truth``; taken from ``sys.argv`` when None.

    Returns:
        0, or 2 on bad input.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.real_truth", description=__doc__)
    data = os.environ.get(DATA_VARIABLE)
    parser.add_argument(
        "--data", type=Path, default=data, metavar="DIR", help="folder of the reference captures"
    )
    parser.add_argument("--page", type=Path, required=True, metavar="DIR", help="folder of the page")
    args = parser.parse_args(arguments)
    try:
        with tempfile.TemporaryDirectory() as out, in_parallel() as mapper:
            context = Context(args.data, Path(out))
            found = by_scaling(context.require_data(), SCALINGS, mapper)
            write_page(args.page, found, before_rows(context.require_data(), context.out, mapper))
    except (MbkfError, OSError) as error:
        print(f"benchmarks.real_truth: error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
