"""Videos beside the captures: ranges of their bytes, their begins in the session file, and no other file."""

from urllib.parse import quote

import pytest

from mbkf.app.videos import MOST_VIDEOS, linked_video, video_data
from mbkf.io.session import read_session
from mbkf.io.session_change import version_of
from mbkf.io.trial_video import TrialVideo
from tests.app.asking import asked, changed

CONTENT = bytes(range(256)) * 40
VIDEOS = "/trial/videos?session=P1&trial=walk1"


@pytest.fixture(scope="module", autouse=True)
def session(server):
    folder = server.workspace.root / "P1"
    (folder / "walk1 side.mp4").write_bytes(CONTENT)
    (folder / "camera.webm").write_bytes(b"other")
    (server.workspace.root / "secret.mp4").write_bytes(b"secret")
    (folder / "link.mp4").symlink_to(server.workspace.root / "secret.mp4")
    return folder


def fetched(server, cookie, name, **headers):
    address = f"/trial/video?session=P1&file={quote(name, safe='')}"
    return asked(server, address, **{"Cookie": cookie, **headers})


@pytest.mark.parametrize(
    ("range_", "status", "part"),
    [
        ("bytes=0-", 206, slice(0, None)), ("bytes=100-199", 206, slice(100, 200)), ("bytes=-7", 206, slice(-7, None)),
        ("bytes=9000-99999999", 206, slice(9000, None)), ("bytes=0-1,5-6", 200, slice(0, None)),
        ("pieces=0-1", 200, slice(0, None)), ("bytes=", 200, slice(0, None)), ("bytes=99999-", 416, slice(0, 0)),
    ],
)  # fmt: skip
def test_one_range_is_given_and_every_other_request_gets_the_whole(server, cookie, range_, status, part):
    answer, body = fetched(server, cookie, "walk1 side.mp4", Range=range_)
    assert (answer.status, body) == (status, CONTENT[part])
    if status == 206:
        first = part.indices(len(CONTENT))[0]
        assert answer.headers["Content-Range"] == f"bytes {first}-{first + len(body) - 1}/{len(CONTENT)}"
    assert status == 416 or answer.headers["Content-Type"] == "video/mp4"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize(
    "name",
    [
        "../secret.mp4",
        "link.mp4",
        "session.toml",
        "walk1.c3d",
        "",
        ".",
        "/etc/passwd",
        "P1/camera.webm",
        "x\0.mp4",
    ],
)
def test_no_other_file_is_given(server, cookie, name):
    answer, body = fetched(server, cookie, name)
    assert answer.status == 404 and b"not beside the captures" in body


def test_without_the_token_or_a_session_nothing_is_given(server, cookie):
    assert asked(server, "/trial/video?session=P1&file=camera.webm")[0].status == 403
    assert asked(server, "/trial/video?session=..&file=secret.mp4", Cookie=cookie)[0].status == 400


def test_a_chosen_video_and_its_begin_are_kept_and_shown(server, cookie, session):
    workspace = server.workspace
    found = video_data(workspace, "P1", "walk1")
    assert found["files"] == ["walk1 side.mp4", "camera.webm"]
    assert found["shown"] == {"file": "walk1 side.mp4", "begins_s": 0.0} and found["video"] == []
    video = [{"file": "camera.webm", "begins_s": -0.37}]
    status, said = changed(server, cookie, VIDEOS, {"base": [], "video": video}, found["version"])
    assert status == 200 and said == {"video": video, "version": version_of(video)}
    assert read_session(session / "session.toml").trial("walk1").videos == (TrialVideo("camera.webm", -0.37),)
    assert video_data(workspace, "P1", "walk1")["shown"] == video[0]
    other = [{"file": "camera.webm", "begins_s": 5.0}]
    status, said = changed(server, cookie, VIDEOS, {"base": [], "video": other}, version_of([]))
    assert status == 409 and said["video"] == video and said["differences"]
    address = linked_video(workspace, "P1", "walk1", saved=False).address
    assert asked(server, f"/trial/{address}", Cookie=cookie)[1] == b"other"
    assert linked_video(workspace, "P1", "walk1", saved=True).address == "./camera.webm"


@pytest.mark.parametrize(
    "sent",
    [
        None,
        {"video": []},
        {"base": [], "video": {}},
        {"base": [], "video": [{"file": "a.mp4"}] * (MOST_VIDEOS + 1)},
    ],
)
def test_a_request_without_videos_is_refused(server, cookie, sent):
    status, said = changed(server, cookie, VIDEOS, sent, version_of([]))
    assert status == 400 and "videos under" in said["trouble"]
