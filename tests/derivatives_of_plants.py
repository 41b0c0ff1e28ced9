"""Cases of tests/test_jacobians.py that nobody writes: every plant's ``transition``."""

from tests.derivatives import checks
from tests.plant_contract import made, plant_classes, tolerance, transition


def address(kind):
    """Dotted name of a plant's transition, below ``mbkf`` where it is in there."""
    return f"{kind.__module__.removeprefix('mbkf.')}.{kind.__name__}.transition"


def add_case(kind):
    def compare(rng):
        return {address(kind): transition(*made(kind, rng), rng)}

    compare.__name__ = kind.__name__
    checks(address(kind), tolerance=tolerance(kind))(compare)


for found in plant_classes().values():
    add_case(found)
