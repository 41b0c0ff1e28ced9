"""The pictures of a film follow the result's time at a constant rate."""

import base64
import io

import numpy as np
import pytest
from PIL import Image

from mbkf.viz.film.pictures import _decoded, film_rows


@pytest.mark.parametrize("rate", [30.0, 50.0, 100.0, 97.3])
def test_each_picture_shows_the_frame_nearest_to_its_time(rate):
    times = 2.0 + np.arange(200) / rate
    rows = film_rows(times, 7, 25.0)
    wanted = times[7] + np.arange(len(rows)) / 25.0
    assert rows[0] == 7
    assert len(rows) == int((times[-1] - times[7]) * 25.0 + 1e-6) + 1
    np.testing.assert_array_equal(rows, [np.abs(times - t).argmin() for t in wanted])


def test_lost_frames_do_not_change_the_pace():
    times = np.delete(np.arange(300) / 100.0, np.s_[100:200])
    rows = film_rows(times, 0, 25.0)
    assert len(rows) == 75
    np.testing.assert_allclose(times[rows[:25]], np.arange(25) / 25.0, atol=1e-12)
    assert set(rows[26:49]) == {99, 100}, "the last frame before them, then the first one after"
    np.testing.assert_allclose(times[rows[50:]], 2.0 + np.arange(25) / 25.0, atol=1e-12)


def test_a_single_frame_is_a_picture():
    np.testing.assert_array_equal(film_rows(np.array([3.0]), 0, 25.0), [0])
    np.testing.assert_array_equal(film_rows(np.array([3.0, 3.01]), 1, 25.0), [1])


def test_a_picture_comes_back_as_it_was_drawn():
    drawn = np.random.default_rng(0).integers(0, 256, (6, 8, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(drawn).save(file, "PNG")

    address = "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()
    np.testing.assert_array_equal(_decoded(address), drawn)
