"""Addresses of this computer only, and others."""

import pytest

from mbkf.stream.loopback import LOOPBACK, is_loopback


@pytest.mark.parametrize("address", [LOOPBACK, "127.1.2.3", "::1", "localhost"])
def test_addresses_of_this_computer(address):
    assert is_loopback(address)


@pytest.mark.parametrize("address", ["0.0.0.0", "192.168.1.10", "::", "example.org", ""])
def test_other_addresses(address):
    assert not is_loopback(address)
