"""Sessions are told, stated and run; every failure is a sentence."""

from urllib.parse import quote

import pytest

from tests.app.asking import asked, changed, plain
from tests.studies import walk_folder


def test_the_page_loads_nothing_from_elsewhere(server, cookie):
    answer, text = asked(server, "/", Cookie=cookie)
    page = text.decode()
    assert answer.status == 200 and "default-src 'none'" in page
    assert "{{" not in page and "src=" not in page and "http" not in page.replace("http-equiv", "")


def test_sessions_are_told_stated_and_run(server, cookie):
    status, told = plain(server, cookie, "/sessions")
    assert status == 200 and [one["id"] for one in told["sessions"]][:1] == ["P1"]
    version = plain(server, cookie, "/session?session=P1")[1]["version"]
    status, told = changed(server, cookie, "/session?session=P1", {"notes": {"mass_kg": 85.7}}, version)
    assert status == 200 and told["notes"] == {"mass_kg": 85.7}
    assert plain(server, cookie, "/run?session=P1&do=start", "POST")[1]["run"]["state"] in {
        "waiting",
        "running",
    }
    while plain(server, cookie, "/session?session=P1")[1]["run"]["state"] in {"waiting", "running"}:
        pass
    told = plain(server, cookie, "/session?session=P1")[1]
    assert told["run"]["state"] == "finished" and told["trials"][1]["status"] == "done"


@pytest.mark.parametrize(
    ("path", "method", "body", "told"),
    [
        ("/session?session=P9", "GET", None, "no session 'P9'"),
        ("/run?session=P9", "POST", None, "no session 'P9'"),
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


def test_a_session_is_renamed_deleted_and_comes_back(server, cookie):
    content = (walk_folder() / "trial.c3d").read_bytes()
    assert plain(server, cookie, "/put?file=P8/walk.c3d", "POST", content)[0] == 200
    made = plain(server, cookie, "/arrange?do=move&session=P8&to_session=P9", "POST")[1]
    assert made["session"] == "P9" and (server.workspace.root / "P9" / "walk.c3d").read_bytes() == content
    assert plain(server, cookie, "/arrange?do=delete&session=P9&trial=walk", "POST")[0] == 200
    assert plain(server, cookie, "/session?session=P9")[0] == 400
    moved = plain(server, cookie, "/bin")[1]["moved"]
    assert [(one["act"], one["session"], one["trial"]) for one in moved] == [
        ("delete", "P9", "walk"),
        ("move", "P8", ""),
    ]
    status, said = plain(server, cookie, "/arrange?do=move&session=P1&to_session=P9", "POST")
    assert (status, said["key"], said["values"]) == (409, "refused_in_the_way", ["P9"])
    assert plain(server, cookie, "/arrange?session=P1&trial=trial", "POST")[0] == 400
    assert plain(server, cookie, "/arrange?do=delete&session=P1")[0] == 405
    for one in moved:
        assert plain(server, cookie, f"/arrange?do=undo&key={one['key']}", "POST")[0] == 200
    assert (server.workspace.root / "P8" / "walk.c3d").read_bytes() == content
