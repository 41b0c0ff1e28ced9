"""Addresses of this computer only, and others."""

import pytest

from mbkf.stream.loopback import (
    LOOPBACK,
    OWN_PAGES,
    is_loopback,
    is_page_of,
    is_token,
    names_this_computer,
)


@pytest.mark.parametrize("address", [LOOPBACK, "127.1.2.3", "::1", "localhost"])
def test_addresses_of_this_computer(address):
    assert is_loopback(address)


@pytest.mark.parametrize("address", ["0.0.0.0", "192.168.1.10", "::", "example.org", ""])
def test_other_addresses(address):
    assert not is_loopback(address)


@pytest.mark.parametrize(
    ("host", "own"),
    [
        ("localhost:80", True), ("127.0.0.1:1234", True), ("[::1]:80", True), ("evil.example:80", False), ("", False),
        ("127.0.0.1.evil.example", False), ("[", False), ("localhost.evil.example:80", False),
    ],
)  # fmt: skip
def test_names_of_this_computer(host, own):
    assert names_this_computer(host) == own


@pytest.mark.parametrize(
    ("origin", "own"),
    [
        (None, True), ("http://a:1", True), ("http://a:2", False), ("https://evil.example", False), ("null", False),
        ("http://[", False), ("", False),
    ],
)  # fmt: skip
def test_pages_of_a_server(origin, own):
    assert is_page_of(origin, "a:1") == own


@pytest.mark.parametrize("origin", ["http://localhost:3000", "https://127.0.0.1", "http://[::1]:8"])
def test_pages_of_this_computer(origin):
    assert OWN_PAGES.fullmatch(origin)


@pytest.mark.parametrize(
    "origin", ["http://localhost.evil.example", "ftp://localhost", "null", "http://127.0.0.2"]
)
def test_other_pages(origin):
    assert not OWN_PAGES.fullmatch(origin)


def test_a_token_is_compared_whole():
    assert is_token("", "") and is_token("ab", "ab")
    assert not is_token("", "ab") and not is_token("a", "ab") and not is_token("ä", "ab")
