"""A made person, walking on the spot on two plates."""

from dataclasses import replace

import pytest

from mbkf.trial.scale import scale
from tests.captures import MASS_KG, made_capture


@pytest.fixture(scope="session")
def capture():
    """80 frames at 100 Hz, plates at 1000 Hz."""
    return made_capture(80)


@pytest.fixture(scope="session")
def scaled():
    """The person with the covariance of scaling, from which spreads by the body follow."""
    return scale(made_capture(30, 0.0), mass_kg=MASS_KG)


@pytest.fixture(scope="session")
def subject(scaled):
    """The person as known exactly: what happens to a stream does not depend on spreads by the body."""
    return replace(scaled, covariance=None)
