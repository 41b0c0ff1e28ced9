"""What tests of benchmarks leave as they found it."""

import pytest

from mbkf.synthesis import motions


@pytest.fixture(scope="module", autouse=True)
def motions_of_benchmarks():
    """Motions that a benchmark registers are forgotten after its tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motions, "_MOTIONS", dict(motions._MOTIONS))
        yield
