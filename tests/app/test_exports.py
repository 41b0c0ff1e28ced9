"""A trial's result is downloaded as a file of other programs; what cannot be is told, and nothing is left behind."""

import json

import pytest

from mbkf.app import exports as module
from mbkf.app.exports import export
from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.results_folder import write_reconstruction
from mbkf.stream.run.report import LIVE_FILE
from mbkf.trial.results.summary import summarise
from tests.app.asking import asked, plain
from tests.recordings import walk

NAME = "live-é"


@pytest.fixture(scope="module")
def recording(server):
    folder = server.workspace.place("P1") / NAME
    write_reconstruction(walk(), summarise(walk()), folder)
    (folder / LIVE_FILE).write_text(json.dumps({"frames_in": walk().frames, "frames_lost": 0}))
    return folder


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    """Where files are made for a download."""
    monkeypatch.setattr(module.tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize(
    ("kind", "begins"), [("c3d", b"\x02\x50"), ("csv", b"time_s,"), ("bvh", b"HIERARCHY"), ("glb", b"glTF")]
)
def test_a_result_is_downloaded(server, cookie, recording, own_folder, kind, begins):
    answer, content = asked(server, f"/trial/export?session=P1&trial=live-%C3%A9&to={kind}", Cookie=cookie)
    assert answer.status == 200 and content.startswith(begins)
    assert len(content) == int(answer.headers["Content-Length"])
    assert answer.headers["Content-Disposition"] == f"attachment; filename*=utf-8''live-%C3%A9.{kind}"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert list(own_folder.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("session=P1&trial=live-%C3%A9&to=exe", "unknown format 'exe'"),
        ("session=P1&trial=live-%C3%A9", "unknown format"),
        ("session=P1&trial=other&to=c3d", "no result of 'other'"),
        ("session=P9&trial=other&to=c3d", "no session 'P9'"),
        ("session=P1&trial=../P1/live-%C3%A9&to=c3d", "no result"),
    ],
)
def test_what_cannot_be_made_is_told(server, cookie, recording, own_folder, words, why):
    status, told = plain(server, cookie, f"/trial/export?{words}")
    assert status == 400 and why in told["trouble"]
    assert list(own_folder.iterdir()) == []


def test_films_are_made_one_at_a_time(recording, tmp_path, monkeypatch):
    def film(r, kind, path):
        assert module._FILMING.locked()
        path.write_bytes(kind.encode())

    monkeypatch.setattr(module, "write_film", film)
    assert export(recording, "mp4") == b"mp4"
    assert not module._FILMING.locked()


def test_a_film_that_cannot_be_made_says_why(server, cookie, recording, monkeypatch, own_folder):
    def refuse(*_):
        raise InvalidInput("a film needs Chromium")

    monkeypatch.setattr(module, "write_film", refuse)
    status, told = plain(server, cookie, "/trial/export?session=P1&trial=live-%C3%A9&to=gif")
    assert (status, told) == (400, {"trouble": "a film needs Chromium"})
    assert list(own_folder.iterdir()) == []


def test_an_unknown_format_is_refused_before_anything_is_read(tmp_path):
    with pytest.raises(UnknownName, match="urdf"):
        export(tmp_path / "nothing", "urdf")
