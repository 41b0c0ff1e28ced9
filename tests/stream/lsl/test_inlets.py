"""Inlets receive once they are opened; a lost stream is looked for among those of its name that were not refused."""

from types import SimpleNamespace

import pytest

from mbkf.stream.lsl.inlets import LostStream, inlet_of, opened

LOST, LATE = type("LostError", (Exception,), {}), type("TimeoutError", (Exception,), {})


class Library:
    """What an inlet is made with, and streams that are there by and by."""

    proc_clocksync = 1
    util = SimpleNamespace(LostError=LOST, TimeoutError=LATE)

    def __init__(self, *found):
        self.made, self.found = [], list(found)

    def StreamInlet(self, info, **options):
        self.made.append(options)
        return info

    def ContinuousResolver(self, prop, name, forget_after):
        assert (prop, name) == ("name", "walk")
        return SimpleNamespace(results=lambda: self.found)


class Inlet:
    def __init__(self, opening=None, timing=None):
        self.errors, self.calls = {"open": opening, "time": timing}, []

    def _call(self, what):
        self.calls.append(what)
        if self.errors[what]:
            raise self.errors[what]()

    def open_stream(self, timeout):
        self._call("open")

    def time_correction(self, timeout):
        self._call("time")


@pytest.mark.parametrize("synchronised", [False, True])
def test_clocks_are_only_compared_where_stamps_number_frames(synchronised):
    library, inlet = Library(), Inlet()
    assert inlet_of(library, "stream", synchronised) == "stream"
    assert library.made[0]["processing_flags"] == int(synchronised) and not library.made[0]["recover"]
    assert opened(library, inlet, synchronised)
    assert inlet.calls == ["time", "open"][1 - synchronised :]


@pytest.mark.parametrize("inlet", [Inlet(LOST), Inlet(LATE), Inlet(timing=LATE)])
def test_a_stream_that_does_not_answer_is_not_open(inlet):
    assert not opened(Library(), inlet, True)


def stream(uid, created_s):
    return SimpleNamespace(uid=lambda: uid, created_at=lambda: created_s)


def test_the_newest_stream_of_a_name_is_the_one_that_is_back():
    """The one that broke off is listed for a while."""
    old, new = stream("a", 1.0), stream("b", 2.0)
    assert LostStream(Library(old, new), "walk").found() is new


def test_a_refused_stream_is_passed_over_for_the_next_of_its_name():
    one, other = stream("a", 2.0), stream("b", 1.0)
    library = Library(one)
    lost = LostStream(library, "walk")
    assert lost.found() is one
    lost.refuse(one)
    assert lost.found() is None
    library.found.append(other)
    assert lost.found() is other
