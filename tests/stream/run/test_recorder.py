"""All that a frame brings is recorded once, impossible points as missing."""

from types import SimpleNamespace

import numpy as np

from mbkf.stream.run.recorder import Recorder
from mbkf.stream.source import PlateSamples, SourceFrame
from mbkf.trial.live.log import plates_dtype
from mbkf.trial.live.recording import MOST_POINTS

FILES = SimpleNamespace(
    markers=SimpleNamespace(
        dtype=np.dtype([("number", "<i8"), ("markers", "<f8", (2, 3)), ("residuals", "<f4", (2,))])
    ),
    points=SimpleNamespace(),
    samples=SimpleNamespace(dtype=plates_dtype(1)),
)


def taken(*frames):
    """Rows by file, of frames (number, markers, points, samples)."""
    rows = {name: [] for name in ("markers", "points", "samples")}
    names = {id(getattr(FILES, name)): name for name in rows}
    recorder = Recorder(FILES, lambda file, some: rows[names[id(file)]].extend(some))
    for number, markers, points, samples in frames:
        index = np.array(samples, dtype=np.int64)
        plates = PlateSamples(index, np.ones((len(index), 1, 6)) * index[:, None, None])
        recorder.take(number, SourceFrame(99, 0.0, np.array(markers), np.array(points), plates), plates)
    return rows


HERE, GONE, FAR = [1.0, 2.0, 3.0], [np.nan] * 3, [1.0, 2.0, 3e9]


def test_markers_that_are_too_far_away_are_missing():
    (row,) = taken((5, [HERE, FAR], np.zeros((0, 3)), []))["markers"]
    assert row["number"] == 5
    np.testing.assert_array_equal(row["markers"], [HERE, GONE])


def test_points_are_those_that_are_there():
    rows = taken((5, [HERE, HERE], [HERE, GONE, FAR, HERE], []))["points"]
    assert [(row["number"], list(row["point"])) for row in rows] == [(5, HERE), (5, HERE)]


def test_residuals_stay_with_their_points():
    rows = {"markers": [], "points": []}
    recorder = Recorder(
        FILES, lambda file, some: rows["markers" if file is FILES.markers else "points"].append(some)
    )
    none = PlateSamples(np.zeros(0, dtype=np.int64), np.zeros((0, 1, 6)))
    markers, points = np.array([HERE, GONE]), np.array([GONE, HERE, FAR, HERE])
    residuals = 1e-3 * np.arange(6.0)
    recorder.take(5, SourceFrame(99, 0.0, markers, points, none, residuals_m=residuals), none)
    recorder.take(6, SourceFrame(99, 0.0, markers, points, none), none)
    stated, unstated = (row["residuals"][0] for row in rows["markers"])
    np.testing.assert_allclose(stated, [0.0, 1e-3], rtol=1e-6)
    np.testing.assert_allclose(rows["points"][0]["residual"], [3e-3, 5e-3], rtol=1e-6)
    assert np.isnan(unstated).all() and np.isnan(rows["points"][1]["residual"]).all()


def test_the_number_of_points_of_a_frame_is_bounded():
    assert len(taken((5, [HERE, HERE], [HERE] * (MOST_POINTS + 1), []))["points"]) == MOST_POINTS


def test_samples_come_once_also_with_a_frame_that_is_too_late():
    none = np.zeros((0, 3))
    rows = taken(
        (5, [HERE, HERE], none, [1, 2]), (None, [HERE, HERE], none, [2, 3]), (6, [HERE, HERE], none, [1, 2])
    )
    assert [int(row["number"]) for row in rows["markers"]] == [5, 6]
    assert [(int(row["index"]), row["wrench"][0, 0]) for row in rows["samples"]] == [(1, 1), (2, 2), (3, 3)]
