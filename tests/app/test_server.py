"""The server listens on this computer alone, and says why it cannot."""

import pytest

from mbkf.app.server import AppServer
from mbkf.errors import InvalidInput


def test_a_port_that_is_taken_is_told(server, tmp_path):
    with pytest.raises(InvalidInput, match="cannot be served at port"):
        AppServer(tmp_path / "lab", server.port)
