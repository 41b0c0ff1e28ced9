"""Some trials of the campaign again, by their seeds: what they are, and what came of them."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence

from benchmarks.campaign import told
from benchmarks.campaign.trials import outcome


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the trials of the seeds on the command line.

    Args:
        arguments: What follows ``python -m benchmarks.campaign``; taken from ``sys.argv`` when None.

    Returns:
        0.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.campaign", description=__doc__)
    parser.add_argument("--seed", type=int, nargs="+", required=True, help="seeds, as the rows name them")
    for seed in parser.parse_args(arguments).seed:
        print(json.dumps(told(outcome(seed)), indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
