"""A server's answer is read, and nonsense in its place is refused."""

import pytest

from mbkf.errors import InvalidPacket
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.server import read_version
from tests.stream.natnet import layouts


def test_our_own_answer_is_read_back():
    assert read_version(packets.server_info("us", 1510)) == packets.VERSION[:2]


@pytest.mark.parametrize("version", layouts.VERSIONS)
def test_the_version_of_the_protocol_is_told_from_that_of_the_server(version):
    assert read_version(layouts.answer(version)) == version


@pytest.mark.parametrize("version", [(0, 0), (2, 9), (5, 0), (77, 3)])
def test_a_protocol_that_is_not_known_is_refused(version):
    with pytest.raises(InvalidPacket, match=r"3\.0 to 4\.x"):
        read_version(layouts.answer(version))


def test_a_short_answer_is_refused():
    whole = layouts.answer((4, 0))
    for length in range(4, len(whole)):
        with pytest.raises(InvalidPacket):
            read_version(layouts.cut(whole, length))
