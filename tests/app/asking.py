"""Asking a page's server as a browser does."""

import http.client
import json
from contextlib import closing

from tests.waiting import PATIENCE_S


def asked(server, path, method="GET", body=None, **headers):
    with closing(http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE_S)) as connection:
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        return answer, answer.read()


def plain(server, cookie, path, method="GET", body=None):
    answer, text = asked(server, path, method, body, Cookie=cookie)
    return answer.status, json.loads(text)


def changed(server, cookie, path, sent, version):
    """The reply to a change of a note that names the version it began from."""
    answer, text = asked(
        server, path, "POST", json.dumps(sent), **{"Cookie": cookie, "If-Match": f'"{version}"'}
    )
    return answer.status, json.loads(text)
