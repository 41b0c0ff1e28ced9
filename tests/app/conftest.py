"""A page's server over a study, and the cookie that opens it."""

from urllib.parse import urlsplit

import pytest

from mbkf.app.server import AppServer
from tests.app.asking import asked
from tests.studies import runs_here, study
from tests.viz.conftest import browser, opened, tab  # noqa: F401 — for this folder's tests, too


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    study(folder / "lab", trials=1)
    with runs_here():
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
