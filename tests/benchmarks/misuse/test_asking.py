"""A page that answers all questions about its sessions, and one that fails at one of them."""

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from benchmarks.misuse.asking import unanswered


class Page(BaseHTTPRequestHandler):
    """Serves two sessions; the second with the status of the server."""

    def do_GET(self):
        path = self.path.partition("?")[0]
        self.send_response(self.server.status if self.path.endswith("=P%202") else 200)
        self.end_headers()
        self.wfile.write(json.dumps({"sessions": [{"id": "P1"}, {"id": "P 2"}]}).encode())
        self.server.asked.append(path)

    def log_message(self, *_):
        """Nothing is printed."""


@pytest.mark.parametrize(("status", "answered"), [(200, True), (400, True), (500, False)])
def test_every_session_is_asked_for(status, answered):
    with ThreadingHTTPServer(("127.0.0.1", 0), Page) as server:
        server.status, server.asked = status, []
        threading.Thread(target=server.serve_forever, daemon=True).start()
        fault = unanswered(f"http://127.0.0.1:{server.server_port}/?token=x")
        server.shutdown()
    assert (fault == "") is answered and (answered or "500" in fault)
    assert server.asked == ["/", "/sessions", "/session", "/session"]


def test_a_page_that_is_gone_is_named():
    assert unanswered("http://127.0.0.1:1/?token=x").startswith("/: URLError")
