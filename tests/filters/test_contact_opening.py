"""A contact that opens late: the frames since it began are taken again, and the estimate of now knows of it."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.filters.contact_opening import KEPT_EVERY_S, REACH_S, OpenContacts
from mbkf.filters.estimate import Recording
from mbkf.sensors.block import Frame
from mbkf.sensors.supports.block import BEARING

DT = 0.02
EVERY, REACH = round(KEPT_EVERY_S / DT), round(REACH_S / DT)
PARTS = 3


@dataclass(frozen=True)
class Told:
    """An estimate that knows its frame and which parts bore in each frame since another estimate was widened."""

    t: int
    bore: tuple = ()
    started: bool = False
    wide: bool = False
    q: np.ndarray = field(default_factory=lambda: np.zeros(1))
    a: np.ndarray = field(default_factory=lambda: np.zeros(1))
    v: np.ndarray = field(default_factory=lambda: np.zeros(1))
    wrench: np.ndarray = field(default_factory=lambda: np.zeros((2, 6)))
    record: object = None
    placed: bool = True
    tracked: bool = True


class Filter:
    """A filter whose estimates count."""

    dt_s, model = DT, SimpleNamespace(nv=1, mass_kg=70.0)

    def __init__(self):
        self.fails = False

    def widened(self, estimate):
        return estimate if estimate.wide else Told(estimate.t, (), wide=True)

    def step(self, before, recording, t):
        if self.fails:
            raise np.linalg.LinAlgError
        frame = recording.frame(t)
        assert frame.markers_m[0, 0] == before.t + 1
        flags = frame.readings.get(BEARING)
        return Told(before.t + 1, (*before.bore, flags is not None and bool(flags[1])), wide=True)


class Watch:
    """Says which parts bear, and since when."""

    def __init__(self):
        self.flags, self.began, self.noted, self.anew = np.zeros(PARTS, dtype=bool), 0, [], []

    def note(self, one):
        self.noted.append(one.estimate.t)

    def bearing(self):
        return self.flags

    def again(self, frames):
        self.anew += [one.estimate.t for one in frames]

    def forget(self):
        self.noted.clear()


def frame(t):
    return Frame(np.full((1, 3), float(t)), np.zeros((2, 6)))


@pytest.fixture(autouse=True)
def all_plausible(monkeypatch):
    monkeypatch.setattr("mbkf.filters.contact_opening.plausible", lambda estimate, model: True)


def followed(frames):
    """Contacts that have seen so many frames, and what they are found by."""
    found = OpenContacts(Filter(), Watch())
    for t in range(frames):
        found.note(Told(t, started=t == 0), frame(t))
    return found, found.watch


@pytest.mark.parametrize("began", [1, 7, 23, 41])
def test_frames_since_the_beginning_are_taken_again_with_the_contact(began):
    contacts, watch = followed(70)
    assert contacts.opened() is None
    watch.flags, watch.began = np.array([False, True, False]), began
    now = contacts.opened()
    assert now.t == 69 and sum(now.bore) == began and all(now.bore[-began:])
    assert len(now.bore) - began < EVERY, "no earlier than the estimate kept before"
    assert watch.anew == list(range(70 - len(now.bore), 70))
    assert contacts.opened() is None, "once"


def test_a_contact_that_began_before_all_that_is_kept_acts_in_all_of_it():
    contacts, watch = followed(400)
    watch.flags, watch.began = np.array([False, True, False]), 300
    now = contacts.opened()
    assert now.t == 399 and all(now.bore) and REACH - EVERY <= len(now.bore) <= REACH


def test_where_the_steps_fail_the_latest_estimate_gets_room():
    contacts, watch = followed(70)
    contacts._filter.fails = True
    watch.flags, watch.began = np.array([False, True, False]), 10
    now = contacts.opened()
    assert now.t == 69 and now.wide and not watch.anew


def test_nothing_before_a_start_is_taken_again():
    contacts, watch = followed(40)
    contacts.note(Told(0, started=True), frame(0))
    contacts.note(Told(1), frame(1))
    watch.flags, watch.began = np.array([False, True, False]), 30
    assert contacts.opened().bore == (True,)


def test_a_contact_that_closes_and_opens_again_is_taken_again_then():
    contacts, watch = followed(70)
    watch.flags, watch.began = np.array([False, True, False]), 5
    assert contacts.opened() is not None
    contacts.note(Told(70, wide=True), frame(70))
    watch.flags = np.zeros(PARTS, dtype=bool)
    assert contacts.opened() is None
    contacts.note(Told(71, wide=True), frame(71))
    watch.flags = np.array([False, True, False])
    assert contacts.opened() is not None


def test_frames_are_read_with_the_parts_that_bear_besides_those_of_the_recording():
    contacts, watch = followed(1)
    plain = Recording(np.zeros((4, 1, 3)), np.zeros((4, 2, 6)), DT)
    assert contacts.added_to(plain, 2) is plain
    watch.flags = np.array([False, True, False])
    assert contacts.added_to(plain, 2).frame(2).readings[BEARING].tolist() == [0.0, 1.0, 0.0]
    own = Recording(
        plain.markers_m, plain.plates, DT, readings={BEARING: np.eye(4, PARTS), "mine": np.arange(4)}
    )
    read = contacts.added_to(own, 2).frame(2).readings
    assert read[BEARING].tolist() == [0.0, 1.0, 1.0] and read["mine"] == 2


def test_what_is_forgotten_is_not_taken_again():
    contacts, watch = followed(30)
    contacts.forget()
    watch.flags = np.array([False, True, False])
    assert contacts.opened() is None and not watch.noted
