"""The long study is the minute again and again; half-written folders are found."""

import pytest

from benchmarks.misuse import cancelled
from benchmarks.misuse.cancelled import half_written, long_study
from mbkf.io.capture import read_capture


def test_the_long_trial_is_the_short_one_repeated(tmp_path, monkeypatch):
    monkeypatch.setattr(cancelled, "PIECE_S", 2.0)
    lab = long_study(tmp_path / "lab", 3)
    short, long = (
        read_capture(path) for path in (tmp_path / "minute" / "trial.c3d", lab / "P1" / "walk.c3d")
    )
    assert long.markers.frames == 3 * short.markers.frames
    assert long.plates[0].force_n.shape[0] == 3 * short.plates[0].force_n.shape[0]
    assert long.markers.positions_m[short.markers.frames :][5, 0] == pytest.approx(
        short.markers.positions_m[5, 0], nan_ok=True
    )


def test_half_written_results_are_found(tmp_path):
    assert half_written(tmp_path) == []
    (tmp_path / "P1" / "walk").mkdir(parents=True)
    (tmp_path / "P1" / f".walk-{'a' * 32}").mkdir()
    found = half_written(tmp_path)
    assert found[0] == f".walk-{'a' * 32}" and found[1].startswith("walk: ")
