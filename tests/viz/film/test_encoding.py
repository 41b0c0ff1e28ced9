"""Films are read back as they were written: count, size, pace and colours."""

import numpy as np
import pytest
from PIL import Image

from mbkf.io.written import form_of
from mbkf.viz.film.encoding import write_gif, write_mp4

COUNT, HEIGHT, WIDTH, RATE = 30, 72, 128, 25


def pictures():
    """A dark square that moves over a bright ground."""
    for k in range(COUNT):
        made = np.full((HEIGHT, WIDTH, 3), (240, 245, 250), dtype=np.uint8)
        made[20:44, 3 * k : 3 * k + 24] = (180, 60, 20)
        yield made


def assert_alike(found):
    """Every picture differs from what was drawn by little but along edges."""
    for shown, drawn in zip(found, pictures(), strict=True):
        assert shown.shape == drawn.shape
        assert np.median(np.abs(shown.astype(int) - drawn)) <= 4
        assert np.abs(shown[32].astype(int) - drawn[32]).mean() < 6


def test_a_gif_has_its_pictures_pace_and_no_end(tmp_path):
    write_gif(pictures(), RATE, tmp_path / "film")
    assert form_of(tmp_path / "film") is not None
    with Image.open(tmp_path / "film") as film:
        assert (film.format, film.n_frames, film.size) == ("GIF", COUNT, (WIDTH, HEIGHT))
        assert film.info["loop"] == 0
        found = []
        for k in range(COUNT):
            film.seek(k)
            assert film.info["duration"] == 40
            found.append(np.asarray(film.convert("RGB")))
    assert_alike(found)


def test_an_mp4_has_its_pictures_and_pace(tmp_path):
    av = pytest.importorskip("av", reason="PyAV is not installed: pip install '.[film]'")
    write_mp4(pictures(), RATE, tmp_path / "film")
    assert form_of(tmp_path / "film") is not None
    with av.open(str(tmp_path / "film")) as film:
        stream = film.streams.video[0]
        assert (stream.codec_context.name, stream.average_rate, stream.width, stream.height) == (
            "h264",
            RATE,
            WIDTH,
            HEIGHT,
        )
        decoded = list(film.decode(stream))
    np.testing.assert_allclose([frame.time for frame in decoded], np.arange(COUNT) / RATE, atol=1e-6)
    assert_alike([frame.to_ndarray(format="rgb24") for frame in decoded])
    head = (tmp_path / "film").read_bytes()
    assert head[4:8] == b"ftyp" and head.index(b"moov") < head.index(b"mdat"), (
        "played before it is loaded whole"
    )
