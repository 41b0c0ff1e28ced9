"""The benchmark's structure; how long anything takes is not tested."""

import pytest

from benchmarks import synthesis_time
from benchmarks.checks import Context


def test_a_quick_run_gives_both_rows_and_the_files(tmp_path, monkeypatch):
    times = iter([10.0, 12.0, 20.0, 24.0])
    monkeypatch.setattr(synthesis_time, "process_time", lambda: next(times))
    monkeypatch.setattr(synthesis_time, "product_seconds", lambda: 0.001)
    monkeypatch.setattr(synthesis_time, "QUICK_SECONDS", (1.0, 2.0))
    frame, growth = synthesis_time.run(Context(None, tmp_path, quick=True))
    assert frame.value == pytest.approx(4.0 / 200 / 0.001)
    assert growth.value == pytest.approx((4.0 / 200) / (2.0 / 100))
    assert (tmp_path / "walk" / "trial.c3d").is_file()
