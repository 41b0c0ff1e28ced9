"""The whole study without captures."""

import numpy as np
import pytest

import benchmarks.stride_paper as study
from benchmarks.checks import Context
from benchmarks.inertial.cubic_steps import CASES
from benchmarks.stride_paper import choices
from benchmarks.stride_paper.errors import KALMAN, KEY_POINTS, PRINTED, Study
from benchmarks.stride_paper.readings import HEADS, PRINTED_M, Readings


@pytest.fixture
def short(monkeypatch):
    """The two long parts, which have tests of their own, give made-up numbers."""
    errors = np.full((10, 1, 2), 0.01)
    made = Study({(method, case): errors for method in (PRINTED, KEY_POINTS, KALMAN) for case in CASES})
    monkeypatch.setattr(study, "measure", lambda seeds: made)
    words = tuple((str(k),) * len(HEADS) for k in range(400))
    monkeypatch.setattr(study, "search", lambda: Readings(words, np.tile(PRINTED_M + 0.3, (400, 1))))
    monkeypatch.setattr(study, "QUICK_SEEDS", 1)
    monkeypatch.setattr(choices, "SEEDS", 1)


def test_the_page_shows_the_paper_beside_ours(short, tmp_path):
    checks = study.run(Context(None, tmp_path, quick=True))
    assert all(check.passed for check in checks)
    assert len([check for check in checks if check.bounded]) == 25
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "claims of the paper reproduced" in page
    assert "The public captures were not given" in page
    assert page.count("data:image/svg+xml;base64,") == 9
    assert all(f">{value}<" in page for value in ("0.3200", "0.4900", "0.4700", "0.6400"))
    assert {"cases.csv", "switches.csv", "readings.csv", "steps.csv"} <= {
        path.name for path in tmp_path.iterdir()
    }
