"""A result's film, read back: as long as the motion, of its size, the body in it, and time goes on."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from mbkf.cli.main import main
from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.results_folder import write_reconstruction
from mbkf.viz.film import film as module
from mbkf.viz.film.film import FILMS, write_film
from mbkf.viz.film.pictures import FilmSettings
from tests.recordings import recorded

SMALL = FilmSettings(width=320, height=180)


def walk():
    """A second of true walking."""
    return recorded("walk", 1.0, 5)


FIRST = 50
"""First frame in which the body is followed."""


def late_walk():
    """The walk, in whose first half the body is not followed."""
    return replace(walk(), tracked=np.arange(walk().frames) >= FIRST)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory, filming):
    path = tmp_path_factory.mktemp("film") / "walk.gif"
    told = []
    write_film(late_walk(), "gif", path, SMALL, lambda *words: told.append(words))
    with Image.open(path) as film:
        found = []
        for k in range(film.n_frames):
            film.seek(k)
            found.append(np.asarray(film.convert("RGB")).astype(int))
    assert told[-1] == ("Drawing", len(found) - 1, len(found))
    return np.array(found)


@pytest.mark.slow
def test_the_film_is_as_long_as_the_motion(pictures):
    r = late_walk()
    seconds = r.times_s[-1] - r.times_s[FIRST]
    assert pictures.shape == (int(seconds * 25 + 1e-6) + 1, 180, 320, 3)


@pytest.mark.slow
def test_the_body_is_seen(pictures):
    """Its right side is towards blue and its left towards vermillion, in the middle of the picture."""
    for picture in pictures[:: len(pictures) // 4]:
        middle = picture[20:150, 100:220].reshape(-1, 3)
        red, blue = middle[:, 0], middle[:, 2]
        assert (blue - red > 40).mean() > 0.02, "the right side"
        assert (red - blue > 30).mean() > 0.01, "the left side"
        assert picture.std() > 8


@pytest.mark.slow
def test_time_goes_on(pictures):
    """The legs move from picture to picture, and so does the clock in the corner."""
    moved = np.abs(np.diff(pictures, axis=0)).max(axis=3) > 40
    assert (moved[:, 60:150, 100:220].mean(axis=(1, 2)) > 0.002).all()
    assert (moved[:, 160:, 250:].sum(axis=(1, 2)) > 3).all()


@pytest.mark.slow
def test_an_mp4_is_made_by_the_command(filming, tmp_path, capsys, monkeypatch):
    av = pytest.importorskip("av", reason="PyAV is not installed: pip install '.[film]'")
    write, _ = FILMS["mp4"]
    monkeypatch.setitem(FILMS, "mp4", (write, SMALL))
    r = late_walk()
    result = write_reconstruction(r, {}, tmp_path / "result")
    assert main(["export", str(result), "--to", "mp4", "--out", str(tmp_path / "walk.mp4")]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "walk.mp4")
    with av.open(str(tmp_path / "walk.mp4")) as film:
        frames = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert np.shape(frames) == (int((r.times_s[-1] - r.times_s[FIRST]) * 25 + 1e-6) + 1, 180, 320, 3)


@pytest.mark.parametrize("kind", FILMS)
def test_without_a_browser_the_command_says_what_to_install(tmp_path, capsys, monkeypatch, kind):
    for library in ("playwright", *(("av",) if kind == "mp4" else ())):
        pytest.importorskip(library, reason=f"{library} is not installed: pip install '.[film]'")
    monkeypatch.setattr(
        "mbkf.viz.film.browser.ways_to_start", lambda: [{"executable_path": str(tmp_path / "none")}]
    )
    result = write_reconstruction(walk(), {}, tmp_path / "result")
    assert main(["export", str(result), "--to", kind, "--out", str(tmp_path / "film")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and "install one" in told
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_a_body_that_is_never_followed_has_no_film(tmp_path):
    lost = replace(walk(), tracked=np.zeros(walk().frames, dtype=bool))
    with pytest.raises(InvalidInput, match="no motion to film"):
        write_film(lost, "gif", tmp_path / "x.gif")
    assert list(tmp_path.iterdir()) == []


def test_formats_and_places_are_checked_before_anything_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "film_pictures", lambda *_: pytest.fail("drawn"))
    with pytest.raises(UnknownName, match="avi"):
        write_film(walk(), "avi", tmp_path / "x.avi")
    with pytest.raises(FileFormatError, match="is a folder"):
        write_film(walk(), "gif", tmp_path)
