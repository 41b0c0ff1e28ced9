"""What is encoded is decoded to the same, by this project and by ezc3d; what does not fit is refused."""

import ezc3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_encode import encoded
from mbkf.io.c3d_layout import check_layout

RNG = np.random.default_rng(0)


def written(path, frames=7, count=3, channels=2, per_frame=4, first=1, **groups):
    points = RNG.normal(0.0, 500.0, (frames, count, 3)).astype(np.float32).astype(float)
    seen = RNG.random((frames, count)) < 0.7
    analogs = RNG.normal(0.0, 100.0, (channels, frames * per_frame)).astype(np.float32).astype(float)
    own = {"POINT": {"LABELS": [f"M{k}" for k in range(count)], "UNITS": ["mm"]}, **groups}
    path.write_bytes(encoded(own, points, np.where(seen, 0.0, -1.0), analogs, 59.94, first))
    return points, seen, analogs


@settings(max_examples=60, deadline=None)
@given(
    st.integers(1, 30), st.integers(1, 300), st.integers(0, 255), st.integers(1, 20), st.integers(1, 65000)
)
def test_what_is_encoded_is_decoded(tmp_path_factory, frames, count, channels, per_frame, first):
    path = tmp_path_factory.mktemp("made") / "x.c3d"
    points, seen, analogs = written(path, frames, count, channels, per_frame, first)
    layout = check_layout(path)
    found = decode(path, layout)
    np.testing.assert_array_equal(found.points, points)
    np.testing.assert_array_equal(found.residuals >= 0.0, seen)
    if channels:
        np.testing.assert_array_equal(found.analogs, analogs)
    assert layout.first_frame == first and found.notes == ()
    assert found.parameters.texts("POINT", "LABELS") == [f"M{k}" for k in range(count)]


def test_another_library_reads_the_same(tmp_path):
    path, corners = tmp_path / "x.c3d", RNG.normal(0.0, 500.0, (3, 4, 2))
    points, seen, analogs = written(
        path, FORCE_PLATFORM={"USED": 2, "CORNERS": corners}, EVENT={"LABELS": ["a", "bc"]}
    )
    found = ezc3d.c3d(str(path))
    np.testing.assert_array_equal(found["data"]["points"][:3].transpose(2, 1, 0)[seen], points[seen])
    np.testing.assert_array_equal(found["data"]["meta_points"]["residuals"][0].T >= 0.0, seen)
    np.testing.assert_allclose(found["data"]["analogs"][0], analogs, rtol=1e-6)
    np.testing.assert_allclose(found["parameters"]["FORCE_PLATFORM"]["CORNERS"]["value"], corners, rtol=1e-6)
    assert found["parameters"]["EVENT"]["LABELS"]["value"] == ["a", "bc"]
    np.testing.assert_allclose(found["header"]["points"]["frame_rate"], 59.94, rtol=1e-6)


@pytest.mark.parametrize("frames", [65530, 65540])
def test_a_few_frames_beyond_the_header_s_words_are_not_taken_for_padding(tmp_path, frames):
    points, _, _ = written(tmp_path / "x.c3d", frames=frames, count=1, channels=0)
    found = decode(tmp_path / "x.c3d", check_layout(tmp_path / "x.c3d"))
    np.testing.assert_array_equal(found.points, points)


@pytest.mark.parametrize("first", [60000, 70000])
def test_the_first_frame_is_told_beyond_the_header_s_words(tmp_path, first):
    written(tmp_path / "x.c3d", frames=6000, first=first)
    found = decode(tmp_path / "x.c3d", check_layout(tmp_path / "x.c3d"))
    assert found.first_frame == first and len(found.points) == 6000


@pytest.mark.parametrize("first", [1, 60000])
def test_more_frames_than_the_header_counts_are_written_and_read_whole(tmp_path, first):
    path = tmp_path / "x.c3d"
    points, seen, analogs = written(path, frames=66000, count=1, channels=1, per_frame=1, first=first)
    found = decode(path, check_layout(path))
    np.testing.assert_array_equal(found.points, points)
    np.testing.assert_array_equal(found.analogs, analogs)
    np.testing.assert_array_equal(found.residuals >= 0.0, seen)


def test_long_lists_go_on_under_another_name(tmp_path):
    path, words = tmp_path / "x.c3d", [f"{k} " + 100 * "x" for k in range(700)]
    written(path, MORE={"TEXT": words})
    assert decode(path, check_layout(path)).parameters.texts("MORE", "TEXT") == words


def test_what_does_not_fit_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match="holds 255"):
        written(tmp_path / "x.c3d", MORE={"NUMBERS": np.zeros(300)})
    with pytest.raises(InvalidInput, match="300 letters"):
        written(tmp_path / "x.c3d", MORE={"TEXT": ["x" * 300]})
    with pytest.raises(InvalidInput, match="holds 130 560"):
        written(tmp_path / "x.c3d", MORE={f"T{k}": ["x" * 120] * 200 for k in range(9)})


def test_tables_of_texts_are_read_alike_here_and_elsewhere(tmp_path):
    pairs = np.array([("ANGLES", "ANGLE"), ("POWERS", "P")])
    written(tmp_path / "x.c3d", OWN={"PAIRS": pairs})
    flat = ["ANGLES", "ANGLE", "POWERS", "P"]
    assert (
        decode(tmp_path / "x.c3d", check_layout(tmp_path / "x.c3d")).parameters.texts("OWN", "PAIRS") == flat
    )
    found = ezc3d.c3d(str(tmp_path / "x.c3d"))["parameters"]["OWN"]["PAIRS"]
    assert found["value"] == flat
