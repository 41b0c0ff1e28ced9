"""Inlets receive once they are opened; a lost stream is looked for among those of its name that were not refused."""

from types import SimpleNamespace

import pytest

from mbkf.errors import InvalidInput
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


class Stream(Inlet):
    """The information of a stream, which is its inlet as well."""

    def __init__(self, uid, created_s, **errors):
        super().__init__(**errors)
        self.uid, self.created_at, self.info = lambda: uid, lambda: created_s, lambda timeout: uid


def test_the_newest_stream_of_a_name_is_the_one_that_is_back():
    """The one that broke off is listed for a while."""
    old, new = Stream("a", 1.0), Stream("b", 2.0)
    assert LostStream(Library(old, new), "walk").found() is new


def test_a_refused_stream_is_passed_over_for_the_next_of_its_name():
    one, other = Stream("a", 2.0), Stream("b", 1.0)
    library, refusals = Library(one), []
    lost = LostStream(library, "walk")

    def read(full):
        if full == "a":
            raise InvalidInput("it is another one")
        return full.upper()

    assert lost.returned(True, read, refusals.append) is None and lost.found() is None
    library.found.append(other)
    assert lost.returned(True, read, refusals.append) == (other, other, "B")
    assert [str(error) for error in refusals] == ["it is another one"] and other.calls == ["time", "open"]


def test_a_stream_that_is_gone_again_is_not_refused():
    late = Stream("a", 1.0, opening=LATE)
    lost = LostStream(Library(late), "walk")
    assert lost.returned(False, str, pytest.fail) is None and lost.found() is late
