"""Without a subject file whoever stands still is scaled as `scale` does, beside the stream, and then followed."""

import json
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotConverged
from mbkf.io.records import Capture
from mbkf.io.subject import read_subject
from mbkf.model.protocol import load_protocol
from mbkf.stream.run import prompting, standing, still_start
from mbkf.stream.run.report import LIVE_FILE
from mbkf.stream.run.session import LiveSession
from mbkf.stream.run.standing import MOST_KEPT, SUBJECT_FILE, KnownPerson, StandingStart
from mbkf.stream.source import PlateSamples
from mbkf.trial.scale import scale
from tests.captures import MASS_KG, made_capture
from tests.stream.scripted import SETTINGS, ScriptedSource, assert_same, frames_of, offline

pytestmark = pytest.mark.slow

COMES, STANDS = 40, 130
"""Frames in which somebody comes, and stands; then somebody moves."""


@pytest.fixture(scope="module")
def visit() -> Capture:
    """Somebody comes from a metre away, stands on two plates, and moves."""
    standing, moving = made_capture(STANDS, 0.0), made_capture(80)
    still = standing.markers.positions_m
    away = np.linspace(-1.0, 0.0, COMES)[:, None, None] * [1.0, 0.0, 0.0]
    positions = np.concatenate([still[:1] + away, still, moving.markers.positions_m])
    whole = made_capture(len(positions))
    return replace(whole, markers=replace(whole.markers, positions_m=positions))


def cut(capture: Capture, first: int, last: int | None = None) -> Capture:
    """Frames of a capture without its plates."""
    stop = None if last is None else last + 1
    markers = replace(
        capture.markers,
        positions_m=capture.markers.positions_m[first:stop],
        start_time_s=first / capture.markers.rate_hz,
    )
    return replace(capture, markers=markers, plates=())


def begin(folder, source, *, mass_kg=MASS_KG, protocol=None, **options):
    """What `find` gives, and what was said."""
    said = []
    say, progress = options.pop("say", said.append), options.pop("progress", None)
    start = StandingStart(source, "script", KnownPerson(mass_kg, protocol), folder, say, progress)
    stop = options.pop("stop", threading.Event())
    assert start.connect(stop, 1.0)
    return start.find(stop, **options), said


def report_of(folder):
    return json.loads((folder / LIVE_FILE).read_text())


def same_person(found, expected):
    assert (found.mass_kg, found.protocol) == (expected.mass_kg, expected.protocol)
    for name, factor in expected.scale_factors.items():
        assert found.scale_factors[name] == pytest.approx(factor, abs=1e-9)
    for one, other in zip(found.markers, expected.markers, strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(one.position_m, other.position_m, atol=1e-9)


class Impatient(ScriptedSource):
    """Does not wait for a slow reader."""

    patient = False


def test_the_subject_is_that_of_scale_and_the_results_those_of_reconstruct(tmp_path, visit):
    visit = replace(visit, plates=())
    found, said = begin(tmp_path, ScriptedSource(*frames_of(visit)))
    told = found.report
    assert (told["frames"], told["frames_left_out"], told["attempts"]) == (100, 0, 1)
    assert COMES - 5 <= told["first_frame"] <= COMES
    expected = scale(cut(visit, told["first_frame"], told["last_frame"]), mass_kg=MASS_KG)
    same_person(found.subject, expected)
    same_person(read_subject(tmp_path / SUBJECT_FILE), expected)
    assert told["marker_rms_mm"] == expected.report["marker_rms_mm"]
    assert "stand still" in said[0]
    assert [line.split(";")[0] for line in said[1:2]] == ["standing still"]
    assert said[-1].startswith("scaled in")

    session = LiveSession(found.source, found.subject, SETTINGS, tmp_path, "script", told)
    assert session.connect(threading.Event(), 1.0)
    outcome = session.run(threading.Event())
    rest = cut(visit, told["last_frame"] + 1)
    assert outcome.report["frames_processed"] == rest.markers.frames
    assert outcome.report["frames_lost"] == 0
    assert_same(tmp_path, offline(rest, expected))
    assert report_of(tmp_path)["scaling"] == json.loads(json.dumps(told))


def test_points_without_names_are_named_by_the_protocol(tmp_path, visit):
    stream, frames = frames_of(visit, unlabelled=True)
    protocol = load_protocol("reference36")
    found, said = begin(
        tmp_path, ScriptedSource(stream, frames[: COMES + 110]), mass_kg=None, protocol=protocol
    )
    told = found.report
    assert told["mass_from"] == "plates"
    assert "stay where you are" in said[1]
    mass_kg = pytest.approx(MASS_KG, abs=1e-6)
    assert found.subject.mass_kg == mass_kg
    expected = scale(
        cut(visit, told["first_frame"], told["last_frame"]), mass_kg=found.subject.mass_kg, protocol=protocol
    )
    same_person(found.subject, expected)


def test_plates_tell_the_mass_where_none_is_given(tmp_path, visit):
    found, said = begin(tmp_path, ScriptedSource(*frames_of(visit)), mass_kg=None)
    assert (found.report["mass_from"], found.report["mass_kg"]) == ("plates", pytest.approx(MASS_KG))
    assert f"{MASS_KG:.1f} kg by the plates" in said[-1]


@pytest.mark.parametrize(
    ("unlabelled", "plates", "hint"), [(False, False, "--mass KG"), (True, True, "--protocol NAME")]
)
def test_what_has_to_be_known_is_asked_for_at_once(tmp_path, visit, unlabelled, plates, hint):
    stream, _ = frames_of(visit if plates else replace(visit, plates=()), unlabelled)
    start = StandingStart(ScriptedSource(stream, []), "script", KnownPerson(), tmp_path, print)
    with pytest.raises(InvalidInput, match=hint):
        start.connect(threading.Event(), 1.0)
    assert not list(tmp_path.iterdir())


def test_who_never_stands_still_is_told_what_moved(tmp_path, visit):
    moving = cut(visit, COMES + STANDS)
    positions = moving.markers.positions_m + 0.02 * np.arange(80)[:, None, None]
    moving = replace(moving, markers=replace(moving.markers, positions_m=positions))
    with pytest.raises(InvalidInput, match=r"before a person was scaled: marker \w+ moved \d+ mm"):
        begin(tmp_path, ScriptedSource(*frames_of(moving)))
    report = report_of(tmp_path)
    assert report["state"] == "no subject scaled"
    assert report["scaling"]["frames_in"] == 80
    assert not (tmp_path / SUBJECT_FILE).exists()


def test_missing_markers_are_told_by_name(tmp_path, visit):
    positions = np.array(visit.markers.positions_m)
    positions[:, 5:20] = np.nan
    hidden = replace(visit, markers=replace(visit.markers, positions_m=positions), plates=())
    unseen = ", ".join(visit.markers.names[5:9])
    with pytest.raises(InvalidInput, match=rf"21 of 36 markers are seen \(not {unseen} …\), at least 29"):
        begin(tmp_path, ScriptedSource(*frames_of(hidden)))


def test_a_set_that_nobody_knows_is_inferred(tmp_path, visit):
    names = tuple(f"M{k}" for k in range(36))
    strange = replace(visit, markers=replace(visit.markers, names=names), plates=())
    stream, frames = frames_of(strange)
    found, _ = begin(tmp_path, ScriptedSource(stream, frames[COMES : COMES + STANDS]))
    assert found.subject.protocol == "inferred"
    assert found.subject.report["marker_rms_mm"] < 5.0


def test_points_that_are_nobody_are_told_and_it_keeps_trying(tmp_path, visit, monkeypatch):
    monkeypatch.setattr(prompting, "AGAIN_S", 1000.0)
    monkeypatch.setattr(prompting, "TELL_S", 1000.0)
    said = []
    names = tuple(f"M{k}" for k in range(12))
    scattered = np.random.default_rng(4).uniform([-0.4, -0.4, 0.0], [0.4, 0.4, 1.7], (len(names), 3))
    places = np.broadcast_to(scattered, (visit.markers.frames, *scattered.shape))
    strange = replace(visit, markers=replace(visit.markers, names=names, positions_m=places), plates=())
    stream, frames = frames_of(strange)
    still = frames[COMES : COMES + STANDS]
    with pytest.raises(InvalidInput, match=r"scaling failed: .*--protocol"):
        begin(tmp_path, ScriptedSource(stream, 2 * still), say=said.append)
    assert len([line for line in said if "scaling failed" in line]) == 1, (
        "the same thing is not said at once again"
    )
    report = report_of(tmp_path)
    assert report["scaling"]["attempts"] == 2
    assert {event["kind"] for event in report["events"]} == {"scaling"}


def test_after_a_failure_the_next_second_of_standing_is_taken(tmp_path, visit):
    """At first the person is three times as tall as anyone."""
    stream, frames = frames_of(replace(visit, plates=()))
    still = frames[COMES : COMES + STANDS]
    wrong = [replace(frame, markers_m=3.0 * frame.markers_m) for frame in still]
    found, said = begin(tmp_path, ScriptedSource(stream, wrong + still))
    assert found.report["attempts"] == 2
    assert any("scaling failed" in line and "stand still once more" in line for line in said)
    same_person(
        found.subject,
        scale(cut(visit, found.report["first_frame"], found.report["last_frame"]), mass_kg=MASS_KG),
    )


def test_the_stream_is_read_while_scaling_runs(tmp_path, visit, monkeypatch):
    stream, frames = frames_of(replace(visit, plates=()))
    more = [replace(frames[-1], number=len(frames) + k) for k in range(200)]
    source = Impatient(stream, frames + more)

    def slow(capture, **known):
        while source.script:
            assert threading.current_thread() is not threading.main_thread()
        return scale(capture, mass_kg=known["mass_kg"])

    monkeypatch.setattr(standing, "scale_standing", slow)
    found, _ = begin(tmp_path, source)
    told = found.report
    assert told["frames_in"] == len(frames) + len(more)
    after = len(frames) + len(more) - told["last_frame"] - 1
    assert (told["frames_kept_waiting"], told["frames_left_out"]) == (MOST_KEPT, after - MOST_KEPT)
    kept = [found.source.read(0.0).number for _ in range(MOST_KEPT)]
    assert kept == [frame.number for frame in (frames + more)[-MOST_KEPT:]]
    with pytest.raises(EOFError):
        found.source.read(0.0)


@pytest.mark.parametrize("scaling", [False, True])
def test_it_can_be_stopped_at_any_time(tmp_path, visit, monkeypatch, scaling):
    stream, frames = frames_of(replace(visit, plates=()))
    stop, forever = threading.Event(), threading.Event()

    class Stopping(Impatient):
        def read(self, timeout_s):
            if len(self.script) <= (40 if scaling else 200):
                stop.set()
            return super().read(timeout_s)

    monkeypatch.setattr(standing, "scale_standing", lambda *_, **__: forever.wait())
    found, _ = begin(tmp_path, Stopping(stream, frames), stop=stop)
    forever.set()
    assert found is None
    report = report_of(tmp_path)
    assert (report["state"], report["ended_by"]) == ("no subject scaled", "it was stopped")
    assert report["scaling"]["attempts"] == int(scaling)


def test_a_source_that_fails_or_falls_silent_is_gone_on_with(tmp_path, visit, monkeypatch):
    monkeypatch.setattr("mbkf.stream.receiving.reader.PAUSE_S", 0.01)
    stream, frames = frames_of(replace(visit, plates=()))
    broken = [*frames[: COMES + 60], OSError("unreachable"), None, *frames[COMES + 60 :]]
    found, _ = begin(tmp_path, ScriptedSource(stream, broken))
    assert [event["kind"] for event in found.report["events"]] == ["source"]
    assert found.report["frames"] == 100


def test_patience_ends(tmp_path, visit):
    class Silent(ScriptedSource):
        def read(self, timeout_s):
            return None

    stream, _ = frames_of(visit)
    with pytest.raises(InvalidInput, match="0 s passed before a person was scaled: no markers are seen yet"):
        begin(tmp_path, Silent(stream, []), patience_s=0.0)


def test_what_is_waited_for_is_told_now_and_then(tmp_path, visit, monkeypatch):
    monkeypatch.setattr(prompting, "TELL_S", 0.0)
    stream, frames = frames_of(replace(visit, plates=()))
    found, said = begin(tmp_path, ScriptedSource(stream, frames))
    assert any("waiting for a person to stand still" in line and "moved" in line for line in said)
    assert "waiting" in {event["kind"] for event in found.report["events"]}


def test_the_share_of_standing_grows_while_somebody_is_still_and_begins_anew_after_a_failure(
    tmp_path, visit, monkeypatch
):
    stream, frames = frames_of(replace(visit, plates=()))
    still = frames[COMES : COMES + STANDS]
    failures = [NotConverged("the markers fit no one who stands")]

    def scaled(capture, **known):
        if failures:
            raise failures.pop()
        return scale(capture, mass_kg=known["mass_kg"])

    monkeypatch.setattr(standing, "scale_standing", scaled)
    shares = []
    found, _ = begin(tmp_path, ScriptedSource(stream, frames[:COMES] + 2 * still), progress=shares.append)
    assert found.report["attempts"] == 2
    assert max(shares[: COMES - 5]) < 0.1, "who comes does not stand"
    full = shares.index(1.0)
    np.testing.assert_allclose(shares[full - 90 : full + 1], np.arange(10, 101) / 100.0)
    assert shares[full + 1 : full + 3] == pytest.approx([0.0, 0.01])
    assert shares[-1] == 1.0


def test_there_is_no_share_of_standing_while_too_few_markers_are_seen_or_no_frames_come(
    tmp_path, visit, monkeypatch
):
    monkeypatch.setattr(still_start, "SILENT_S", 0.05)
    stream, frames = frames_of(replace(visit, plates=()))
    hidden = [f.markers_m.copy() for f in frames[:30]]
    for markers in hidden:
        markers[5:20] = np.nan
    few = [replace(f, markers_m=markers) for f, markers in zip(frames, hidden, strict=False)]
    shares, stop = [], threading.Event()

    class FallingSilent(ScriptedSource):
        def read(self, timeout_s):
            if self.script:
                return super().read(timeout_s)
            time.sleep(0.01)
            return None

    source = FallingSilent(stream, few)

    def progress(share):
        shares.append(share)
        if share is None and not source.script:
            stop.set()

    assert begin(tmp_path, source, progress=progress, stop=stop)[0] is None
    assert set(shares) == {0.0, None}
    assert shares[-1] is None


def test_points_that_cannot_be_do_not_count(tmp_path, visit):
    stream, frames = frames_of(visit)
    far = [replace(f, markers_m=np.full_like(f.markers_m, 1e6), plates=PlateSamples.none(2)) for f in frames]
    with pytest.raises(InvalidInput, match="0 of 36 markers are seen"):
        begin(tmp_path, ScriptedSource(stream, far))
