"""A made person, walking on the spot on two plates."""

import pytest

from mbkf.trial.scale import scale
from tests.captures import MASS_KG, made_capture


@pytest.fixture(scope="session")
def capture():
    """80 frames at 100 Hz, plates at 1000 Hz."""
    return made_capture(80)


@pytest.fixture(scope="session")
def subject():
    return scale(made_capture(30, 0.0), mass_kg=MASS_KG)
