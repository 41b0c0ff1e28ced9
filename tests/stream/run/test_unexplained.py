"""Loads that a live run states: when, how large, as an event, and in live.json."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.record import UNASKED, FrameRecorder
from mbkf.stream.receiving.alignment import ReadyFrame
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.trial.live.filter import live_inputs
from mbkf.trial.loads.running import RunningLoad
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.captures import made_capture
from tests.stream.scripted import frames_of

RATE_HZ = 100.0


@pytest.fixture(scope="module")
def stream():
    return frames_of(made_capture(2))[0]


class Standing:
    """A body at rest whose right plate reads a share of its weight."""

    def __init__(self, stream, subject, filter="dynamic"):
        settings = ReconstructSettings(filter=filter)
        live = live_inputs(stream.marker_names, RATE_HZ, stream.plates, subject, settings)
        self.notes, self.weight_n = [], GRAVITY_M_S2 * subject.mass_kg
        self.watch = LoadWatch(live, RATE_HZ, lambda *note: self.notes.append(note))
        self.rows = FrameRecorder(tracking_filter(filter, live.inputs), len(live.names))
        self.unseen = np.full((len(live.names), 3), np.nan)
        self.q, self.number = live.inputs.sensor.model.neutral(), 0

    def frames(self, count, share, footing=(1, 1), read=0.0):
        """The judgements of so many frames, in which plates read a share of the weight, too."""
        found, plates = [], np.zeros((2, 6))
        plates[1, 2] = read * self.weight_n
        for _ in range(count):
            row, _ = self.rows.row(self.number, self.unseen, None, 0.0)
            row["known"] = row["tracked"] = True
            row["q"], row["footing"], row["wrench"] = self.q, footing, 0.0
            row["v"] = row["a"] = 0.0
            row["wrench"][0, 0, 2] = share * self.weight_n
            ready = ReadyFrame(self.number + 7, 0.0, self.unseen, np.zeros((0, 3)), plates)
            found.append(self.watch.push(ready, row))
            self.number += 1
        return found


def test_a_seat_is_stated_soon_and_once(stream, subject):
    standing = Standing(stream, subject)
    assert not any(one.acts for one in standing.frames(100, 1.0))
    seated = standing.frames(100, 0.4)
    assert seated[40].acts and all(one.acts for one in seated[40:])
    assert seated[-1].force_n == pytest.approx([0.0, 0.0, 0.6 * standing.weight_n], abs=1.0)
    assert not standing.frames(150, 1.0)[-1].acts
    ((kind, what, number, count),) = standing.notes
    assert (kind, count) == ("unexplained", 1) and 107 < number < 107 + 40
    assert what.startswith("unexplained force") and "upward" in what
    (told,) = standing.watch.plain()
    assert 1.0 < told["from_s"] < 1.4 and 2.0 < told["to_s"] < 3.2
    assert told["direction"] == "upward" and told["share_of_weight"] == pytest.approx(0.6, abs=0.01)
    assert told["force_n"] == pytest.approx(0.6 * standing.weight_n, rel=0.02)


def test_a_foot_beside_the_plates_is_not_judged(stream, subject):
    standing = Standing(stream, subject)
    found = standing.frames(100, 0.4, footing=(1, -1))
    assert all(np.isnan(one.force_n).all() and not one.acts for one in found)
    assert standing.watch.plain() == [] and standing.notes == []


def test_a_plate_that_has_just_been_stepped_on_counts_before_a_foot_is_recognised_there(stream, subject):
    """For a third of a second: then something else lies on it."""
    standing = Standing(stream, subject)
    standing.frames(100, 1.0)
    stepping = standing.frames(30, 0.1, read=1.0)
    assert not any(one.acts for one in stepping)
    assert not any(one.acts for one in standing.frames(100, 1.0))
    assert standing.frames(60, 0.1, read=1.0)[-1].acts


def test_a_filter_that_estimates_no_wrench_is_judged_by_the_plates(stream, subject):
    """Both plates read nothing under a body that stands: all of its weight is missing."""
    standing = Standing(stream, subject, "kinematic")
    standing.q = standing.q.copy()
    standing.q[2] += 1.0
    found = standing.frames(100, 1.0, footing=(UNASKED, UNASKED))
    assert found[-1].acts
    assert found[-1].force_n == pytest.approx([0.0, 0.0, standing.weight_n], abs=1.0)


def test_a_load_is_noted_once_its_size_is_known(stream, subject):
    """A large one is stated in a quarter of a second; its size is the mean of half a second."""
    standing = Standing(stream, subject)
    for time_s, force in (
        (0.3, np.full(3, np.nan)),
        (0.5, np.array([0.0, 0.0, 150.0])),
        (0.6, np.full(3, 90.0)),
    ):
        standing.watch._listed(RunningLoad(force, True), time_s, round(100 * time_s))
        if np.isnan(force).any():
            assert standing.notes == [] and standing.watch.plain() == [] and standing.watch.stated() == ()
    ((kind, sentence, frame, _),) = standing.notes
    assert (kind, frame) == ("unexplained", 50) and "150 N upward" in sentence
    (load,) = standing.watch.stated()
    assert (load.from_s, load.to_s) == (0.3, 0.6) and load.force_n == pytest.approx(90.0 * np.sqrt(3.0))


def test_a_load_whose_contact_opens_is_listed_and_not_judged(stream, subject):
    standing = Standing(stream, subject)
    standing.frames(100, 1.0)
    assert standing.frames(60, 0.4)[-1].acts
    row, _ = standing.rows.row(standing.number, standing.unseen, None, 0.0)
    row["known"] = row["tracked"] = True
    row["q"], row["footing"], row["wrench"], row["v"], row["a"] = standing.q, (1, 1), 0.0, 0.0, 0.0
    row["wrench"][0, 0, 2], row["support"] = 0.4 * standing.weight_n, 0.0
    row["support"][0, 0, 2] = 0.6 * standing.weight_n
    ready = ReadyFrame(standing.number + 7, 0.0, standing.unseen, np.zeros((0, 3)), np.zeros((2, 6)))
    assert not standing.watch.push(ready, row).acts
    assert standing.watch.stated() == () and len(standing.watch.plain()) == 1
    assert [one["part"] for one in standing.watch.lists()["contacts"]] == ["pelvis"]
