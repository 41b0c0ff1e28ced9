"""Addresses of this computer only, and others."""

import pytest

from mbkf.stream.loopback import LOOPBACK, is_loopback, own_request


@pytest.mark.parametrize("address", [LOOPBACK, "127.1.2.3", "::1", "localhost"])
def test_addresses_of_this_computer(address):
    assert is_loopback(address)


@pytest.mark.parametrize("address", ["0.0.0.0", "192.168.1.10", "::", "example.org", ""])
def test_other_addresses(address):
    assert not is_loopback(address)


@pytest.mark.parametrize(
    ("host", "origin", "local", "any_port", "own"),
    [
        ("127.0.0.1:80", None, True, False, True),
        ("localhost:80", "http://localhost:80", True, False, True),
        ("localhost:80", "http://localhost:81", True, False, False),
        ("127.0.0.1:80", "http://localhost:81", True, True, True),
        ("127.0.0.1:80", "http://evil.example", True, True, False),
        ("evil.example:80", None, True, True, False),
        ("evil.example:80", "http://evil.example:80", True, False, False),
        ("lab:80", "http://lab:80", False, False, True),
        ("lab:80", "http://lab:81", False, False, False),
        ("lab:80", "http://lab:81", False, True, True),
        ("lab:80", "http://localhost:81", False, True, False),
        ("lab:80", "http://evil.example", False, True, False),
        ("127.0.0.1:80", "null", True, True, False),
        ("127.0.0.1:80", "", True, True, False),
        ("[", None, True, False, False),
        ("127.0.0.1", "http://[", True, True, False),
    ],
)
def test_what_other_pages_cause_is_no_own_request(host, origin, local, any_port, own):
    assert own_request(host, origin, local, any_port) == own
