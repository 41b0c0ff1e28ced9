"""`mbkf live --list` prints the streams of the network, each with the words that follow it."""

import pytest

from mbkf.cli.main import main
from mbkf.cli.stream_list import NOTHING, following
from mbkf.stream import discovery
from mbkf.stream.found import FoundStream

QTM = FoundStream("qualisys", "QTM [8]", "10.0.0.2", "10.0.0.2", {}, 36, 100.0, 2)


def test_words_that_follow_a_stream_are_safe_in_a_shell():
    assert following(FoundStream("lsl", "a", "b", "", {"stream": "a; b"})) == "--from lsl --stream 'a; b'"


def test_streams_are_listed(monkeypatch, capsys):
    searched = []

    def qualisys(local, timeout_s, place):
        searched.append((local, place))
        return [QTM]

    monkeypatch.setattr(discovery, "SEARCHES", {"lsl": lambda *_: 1 / 0, "qualisys": qualisys})
    assert main(["live", "--list", "--from", "qualisys:lab", "--local", "10.0.0.1"]) == 0
    shown = capsys.readouterr().out
    assert "QTM [8]" in shown and "36 markers at 100 Hz, 2 plates" in shown
    assert "mbkf live --from qualisys:10.0.0.2 …" in shown and searched == [("10.0.0.1", "lab")]


def test_nothing_found_says_what_to_do(monkeypatch, capsys):
    monkeypatch.setattr(discovery, "SEARCHES", {"lsl": lambda *_: []})
    assert main(["live", "--list"]) == 0
    shown = capsys.readouterr()
    assert shown.out == "" and NOTHING in shown.err


@pytest.mark.parametrize("source", ["file:walk.c3d", "natnet:10.0.0.2", "x", "x:1"])
def test_other_sources_are_not_searched_for(source, capsys):
    assert main(["live", "--list", "--from", source]) == 2
    assert f"unknown source '{source}'" in capsys.readouterr().err
