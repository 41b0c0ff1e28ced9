"""A Motive is found and described, in unicast and in a group, and its replay does not begin by that."""

import struct
import time
from contextlib import closing

import pytest

from mbkf.stream.asking import Answer
from mbkf.stream.natnet import discovery, packets
from mbkf.stream.natnet.player import NatNetPlayer
from mbkf.stream.played import played
from tests.captures import made_capture
from tests.stream.discovering import HERE, first_answer
from tests.stream.natnet import layouts

PLAYED = played(made_capture(3))


def test_a_motive_is_found_and_its_replay_does_not_begin(monkeypatch):
    monkeypatch.setattr(discovery, "asked", first_answer)
    with closing(NatNetPlayer(PLAYED, HERE, 0)) as player:
        (found,) = discovery.natnet_streams(HERE, 30.0, player.port)
        assert not player.listening()
    assert dict(found.options) == {"server": HERE, "local": HERE, "port": str(player.port)}
    assert (found.name, found.markers, found.rate_hz, found.plates) == ("mbkf replay", 36, None, 2)


def test_a_motive_that_streams_to_a_group_is_followed_there(monkeypatch):
    monkeypatch.setattr(discovery, "_described", lambda *_: None)
    head = layouts.answer((4, 1))[4:]
    whole = packets.message(packets.SERVER_INFO, head + struct.pack("<QHB4B", 1, 1511, 1, 239, 255, 42, 99))
    monkeypatch.setattr(discovery, "asked", lambda *_: [Answer("10.0.0.2", "10.0.0.1", whole)])
    (found,) = discovery.natnet_streams(HERE, 1.0)
    assert dict(found.options) == {"server": "10.0.0.2", "local": "10.0.0.1", "multicast": "239.255.42.99"}
    assert found.markers is None


def test_a_receiver_that_stays_starts_a_replay():
    with closing(NatNetPlayer(PLAYED, HERE, 0)) as player:
        player._asked["client"] = time.monotonic() - 1.0
        assert player.listening()


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"x" * 9,
        struct.pack("<II", 99, 1) + b"QTM\0ab",
        layouts.answer((2, 9)),
        packets.message(packets.DESCRIPTIONS, b"x" * 400),
    ],
)
def test_another_answer_is_no_server(monkeypatch, data):
    monkeypatch.setattr(discovery, "asked", lambda *_: [Answer(HERE, HERE, data)])
    assert discovery.natnet_streams(HERE, 1.0) == []
