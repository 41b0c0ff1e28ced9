"""The server answers the page alone, and every failure with a sentence."""

import http.client
import json
from contextlib import closing
from urllib.parse import quote, urlsplit

import pytest

from mbkf.app.server import AppServer
from mbkf.errors import InvalidInput
from tests.studies import study, walk_folder

PATHS = ("/", "/sessions", "/session?session=P1", "/trial/look?session=P1&trial=walk1")


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    study(folder / "lab", trials=1)
    made = AppServer(folder / "lab", workers=1)
    yield made
    made.close()


@pytest.fixture(scope="module")
def cookie(server):
    answer, _ = asked(server, urlsplit(server.url).path + "?" + urlsplit(server.url).query)
    assert answer.status == 303 and answer.headers["Location"] == "/"
    told = answer.headers["Set-Cookie"]
    assert "HttpOnly" in told and "SameSite=strict" in told
    return told.partition(";")[0]


def asked(server, path, method="GET", body=None, **headers):
    with closing(http.client.HTTPConnection("127.0.0.1", server.port, timeout=30.0)) as connection:
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        return answer, answer.read()


def plain(server, cookie, path, method="GET", body=None):
    answer, text = asked(server, path, method, body, Cookie=cookie)
    return answer.status, json.loads(text)


@pytest.mark.parametrize("path", PATHS)
def test_strangers_are_refused(server, cookie, path):
    own = f"127.0.0.1:{server.port}"
    for headers in (
        {},
        {"Cookie": cookie[:-1] + "x"},
        {"Cookie": cookie, "Host": "evil.example"},
        {"Cookie": cookie, "Origin": "http://evil.example"},
        {"Cookie": cookie, "Origin": "null"},
        {"Cookie": cookie, "Origin": "http://127.0.0.1:1"},
    ):
        assert asked(server, path, **headers)[0].status == 403, headers
    assert asked(server, "/?token=wrong")[0].status == 403
    good = asked(server, path, Cookie=cookie, Origin=f"http://{own}")[0]
    assert good.status in {200, 404}
    assert good.headers["X-Content-Type-Options"] == "nosniff" and good.headers["Cache-Control"] == "no-store"


def test_the_page_loads_nothing_from_elsewhere(server, cookie):
    answer, text = asked(server, "/", Cookie=cookie)
    page = text.decode()
    assert answer.status == 200 and "default-src 'none'" in page
    assert "{{" not in page and "src=" not in page and "http" not in page.replace("http-equiv", "")


def test_sessions_are_told_stated_and_run(server, cookie):
    status, told = plain(server, cookie, "/sessions")
    assert status == 200 and [one["id"] for one in told["sessions"]][:1] == ["P1"]
    status, told = plain(server, cookie, "/session?session=P1", "POST", json.dumps({"mass_kg": 85.7}))
    assert status == 200 and told["notes"] == {"mass_kg": 85.7}
    assert plain(server, cookie, "/run?session=P1&do=start", "POST")[1]["run"]["state"] in {
        "waiting",
        "running",
    }
    while plain(server, cookie, "/session?session=P1")[1]["run"]["state"] in {"waiting", "running"}:
        pass
    told = plain(server, cookie, "/session?session=P1")[1]
    assert told["run"]["state"] == "finished" and told["trials"][1]["status"] == "done"
    for look, sign in (("look", b'id="recording"'), ("report", b"mbkf report")):
        answer, text = asked(server, f"/trial/{look}?session=P1&trial=walk1", Cookie=cookie)
        assert answer.status == 200 and sign in text
    assert asked(server, "/trial/other?session=P1&trial=walk1", Cookie=cookie)[0].status == 404


@pytest.mark.parametrize(
    ("path", "method", "body", "told"),
    [
        ("/session?session=P9", "GET", None, "no session 'P9'"),
        ("/run?session=P9", "POST", None, "no session 'P9'"),
        ("/session?session=P1", "POST", '{"mass_kg": 0}', "mass_kg must be"),
        ("/session?session=P1", "POST", "no json", "no JSON"),
        ("/session?session=P1", "POST", b"\xff\xfe", "no JSON"),
        ("/put?file=..%2Fx.c3d", "POST", b"x", "cannot be a file here"),
        ("/put", "POST", b"x", "cannot be a file here"),
    ],
)
def test_failures_are_sentences(server, cookie, path, method, body, told):
    status, said = plain(server, cookie, path, method, body)
    assert status == 400 and told in said["trouble"]


def test_dropped_files_are_put_beside_the_others(server, cookie):
    content = (walk_folder() / "trial.c3d").read_bytes()
    name = quote("P7/walk ä.c3d")
    assert plain(server, cookie, f"/put?file={name}", "POST", content) == (200, {"put": "P7/walk ä.c3d"})
    assert (server.workspace.root / "P7" / "walk ä.c3d").read_bytes() == content
    told = plain(server, cookie, "/session?session=P7")[1]
    assert told["trials"][0]["file"] == "walk ä.c3d" and told["trials"][0]["kind"] == "walk"


def test_a_port_that_is_taken_is_told(server, tmp_path):
    with pytest.raises(InvalidInput, match="cannot be served at port"):
        AppServer(tmp_path / "lab", server.port)
