"""Cases of tests/test_jacobians.py that nobody writes: every block's ``linearise``, wherever the block speaks."""

import numpy as np

from tests.block_contract import block_classes, derivative, shown, speaks
from tests.block_scenes import situations_of
from tests.derivatives import checks

LEFT_OUT = {"PlantedFeet": "the derivative by the configuration, as it says"}
"""Blocks whose innovations also fall along components that their rows leave out, and what they so neglect."""

SETTLED = {
    "FootPlates": "moments are about ankles that move with the state: their arms times what is left of forces"
}
"""Blocks whose innovations also change by a share of themselves, which their rows leave out, and how."""


def address(kind):
    """Dotted name of a block's derivative, below ``mbkf`` where it is in there."""
    return f"{kind.__module__.removeprefix('mbkf.')}.{kind.__name__}.linearise"


def tolerance(kind):
    """Information falls by its matrix but for what is left of its innovations; rows fall exactly."""
    return 2e-4 if "Information" in str(kind.linearise.__annotations__.get("return")) else 2e-6


def add_case(kind):
    def compare(rng):
        pairs = []
        for situation in situations_of(kind.__name__):
            found = shown(kind, situation, off=int(rng.integers(1000)))
            if speaks(found.says()):
                stated, numeric = derivative(found, rng, kind.__name__ in LEFT_OUT, kind.__name__ in SETTLED)
                scale = np.abs(numeric).max()
                pairs.append((stated / scale, numeric / scale))
        stated, numeric = zip(*pairs, strict=True)
        return {address(kind): (np.vstack(stated), np.vstack(numeric))}

    compare.__name__ = kind.__name__
    checks(address(kind), tolerance=tolerance(kind))(compare)


for found in block_classes().values():
    add_case(found)
