"""`mbkf live` and `mbkf replay` as typed: together over both protocols, ended by Ctrl-C, refused in one line."""

import json
import re
import signal
import socket
import subprocess
import sys
import threading
import uuid
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.cli.stopping import stopped_by_signal
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.subject import read_subject
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.log import FRAMES_FILE
from mbkf.trial.live.results import live_results
from mbkf.viz.live.page import LivePage
from mbkf.viz.live.standing_page import StandingPage
from tests.captures import MASS_KG, made_capture
from tests.waiting import PATIENCE_S, until

pytestmark = pytest.mark.slow


def begun(words):
    """The command as a process of its own, with what it says kept."""
    return subprocess.Popen(
        [sys.executable, "-m", "mbkf", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def run(words):
    return main([str(word) for word in words])


@pytest.fixture(scope="module")
def expected(person, tmp_path_factory):
    """The causal answer of reconstruct to the trial with the subject's own marker positions."""
    out = tmp_path_factory.mktemp("expected")
    words = ["reconstruct", person.trial, "--subject", person.subject, "--keep-markers", "--causal"]
    assert run([*words, "--out", out]) == 0
    return read_reconstruction(out)


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def test_a_file_gives_the_causal_answer_of_reconstruct(person, tmp_path, capsys, expected):
    out = tmp_path / "out"
    words = [
        "live",
        "--from",
        f"file:{person.trial}",
        "--subject",
        person.subject,
        "--speed",
        0,
        "--out",
        out,
    ]
    assert run(words) == 0
    shown = capsys.readouterr()
    assert "frames: 60 received, 0 lost" in shown.out
    assert "36 markers at 100 Hz" in shown.err
    found = read_reconstruction(out)
    for name in ("q", "v", "tau", "foot_wrench", "angles", "moments", "sd_q", "predicted_m"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), atol=1e-9, err_msg=name)
    assert (
        found.later_frames == expected.later_frames == read_summary(out)["later_frames"] == "causal (as live)"
    )
    report = json.loads((out / "live.json").read_text())
    assert {"latency_ms_median", "latency_ms_p99", "latency_ms_max", "rate_hz"} <= set(report)
    assert report["source"] == "file"


def test_a_lag_is_followed_and_told_apart_from_the_latency(person, tmp_path, capsys):
    live, offline = tmp_path / "live", tmp_path / "offline"
    options = ["--subject", person.subject, "--lag", 60]
    assert run(["live", "--from", f"file:{person.trial}", *options, "--speed", 0, "--out", live]) == 0
    shown = capsys.readouterr().out
    assert "fixed lag 60 ms" in shown and "ms, beside a lag of 60.0 ms" in shown
    assert run(["reconstruct", person.trial, *options, "--keep-markers", "--out", offline]) == 0
    found, expected = read_reconstruction(live), read_reconstruction(offline)
    for name in ("q", "v", "tau", "foot_wrench", "angles", "moments", "predicted_m"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), atol=1e-9, err_msg=name)
    assert (found.foot_wrench_sd >= expected.foot_wrench_sd * (1.0 - 1e-9)).all()
    assert json.loads((live / "live.json").read_text())["lag_ms"] == pytest.approx(60.0)
    assert found.lag_ms == expected.lag_ms == 60.0


@pytest.mark.parametrize("protocol", ["lsl", "natnet"])
def test_a_replay_is_followed(person, tmp_path, capsys, protocol):
    out, name, port = tmp_path / "out", f"mbkf-test-{uuid.uuid4().hex[:8]}", free_port()
    live = ["live", "--from", protocol, "--subject", person.subject, "--seconds", 0.6, "--keep-log"]
    replay = ["replay", person.trial, "--to", protocol, "--wait", PATIENCE_S]
    if protocol == "lsl":
        live, replay = [*live, "--stream", name], [*replay, "--name", name]
    else:
        live, replay = [*live, "--port", port], [*replay, "--port", port]
    playing = threading.Thread(target=run, args=(replay,))
    playing.start()
    code = run([*live, "--out", out])
    playing.join()
    assert code == 0, capsys.readouterr().err
    assert "60 frames sent at 100 Hz" in capsys.readouterr().out
    report = json.loads((out / "live.json").read_text())
    assert (report["frames_in"], report["frames_lost"]) == (60, 0)
    assert report["frames_processed"] == 60
    found, again = read_reconstruction(out), live_results(out / LOG_FOLDER)
    np.testing.assert_array_equal(found.tau, again.tau)
    assert found.tracked.all()


def test_a_damaged_log_is_recovered_as_far_as_it_is_whole(person, tmp_path, capsys):
    out = tmp_path / "out"
    words = ["live", "--from", f"file:{person.trial}", "--subject", person.subject, "--speed", 0]
    file = tmp_path / "recorded.c3d"
    assert run([*words, "--keep-log", "--record", file, "--out", out]) == 0
    assert f"{file}: 60 frames recorded" in capsys.readouterr().out
    before = file.read_bytes()
    for name, why in (
        (file, "replaces no other one"),
        (tmp_path / "recorded.trc", "a C3D file is named .c3d"),
    ):
        assert run([*words, "--record", name, "--out", tmp_path / "again"]) == 2
        assert why in capsys.readouterr().err and not (tmp_path / "again").exists()
    file.unlink()
    path = out / LOG_FOLDER / FRAMES_FILE
    path.write_bytes(path.read_bytes()[:-10] + bytes(10))
    capsys.readouterr()
    assert run(["live", "--recover", out]) == 0
    told = capsys.readouterr()
    assert "59 frames recovered" in told.out and file.read_bytes() == before
    assert told.err == "mbkf: 1 frames are left out: frames.log is damaged from there on\n"


SOME_FRAMES = 50_000
"""Bytes of a log."""


def test_ctrl_c_leaves_complete_files(person, tmp_path):
    out = tmp_path / "out"
    words = [
        "live",
        "--from",
        f"file:{person.trial}",
        "--subject",
        person.subject,
        "--speed",
        0.3,
        "--out",
        out,
    ]
    process = begun(words)
    frames = out / LOG_FOLDER / FRAMES_FILE
    until(lambda: frames.is_file() and frames.stat().st_size > SOME_FRAMES)
    process.send_signal(signal.SIGINT)
    printed, errors = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, errors
    assert "it was stopped" in printed
    assert 0 < read_reconstruction(out).frames < 60
    assert json.loads((out / "live.json").read_text())["state"] == "finished"
    assert not (out / LOG_FOLDER).exists()


def test_results_are_shown_and_sent_while_it_runs(person, tmp_path, capsys):
    name = f"mbkf-test-{uuid.uuid4().hex[:8]}"
    words = ["live", "--from", f"file:{person.trial}", "--subject", person.subject, "--speed", 0, "--view"]
    assert run([*words, "--publish", name, "--websocket", 0, "--out", tmp_path / "out"]) == 0
    told = capsys.readouterr().err
    assert "page: http://127.0.0.1:" in told
    assert "results: ws://127.0.0.1:" in told
    assert read_reconstruction(tmp_path / "out").frames == 60


@pytest.fixture(scope="module")
def visit(tmp_path_factory):
    """A file in which somebody stands and then moves."""
    standing, moving = made_capture(110, 0.0), made_capture(40)
    positions = np.concatenate([standing.markers.positions_m, moving.markers.positions_m])
    whole = made_capture(len(positions), markers=replace(moving.markers, positions_m=positions))
    path = tmp_path_factory.mktemp("visit") / "visit.c3d"
    write_c3d(whole, path)
    return path


def test_who_stands_still_is_scaled_as_scale_does_from_the_same_frames(visit, tmp_path, capsys):
    out, static = tmp_path / "out", tmp_path / "static.c3d"
    words = ["live", "--from", f"file:{visit}", "--mass", MASS_KG, "--speed", 0, "--out", out]
    assert run(words) == 0
    told = capsys.readouterr()
    assert "frames: 50 received, 0 lost" in told.out
    steps = (
        "waiting for file",
        "stand still for 1 s",
        "standing still; scaling",
        "scaled in",
        "following visit",
    )
    assert [line.startswith(step) for line, step in zip(told.err.splitlines(), steps, strict=True)] == 5 * [
        True
    ]
    scaling = json.loads((out / "live.json").read_text())["scaling"]
    whole = read_capture(visit)
    stretch = whole.markers.positions_m[scaling["first_frame"] : scaling["last_frame"] + 1]
    write_c3d(replace(whole, markers=replace(whole.markers, positions_m=stretch), plates=()), static)
    assert run(["scale", static, "--mass", MASS_KG, "--out", tmp_path / "twin.toml"]) == 0
    found, twin = read_subject(out / "subject.toml"), read_subject(tmp_path / "twin.toml")
    assert found.scale_factors == pytest.approx(twin.scale_factors, abs=1e-6)
    for one, other in zip(found.markers, twin.markers, strict=True):
        np.testing.assert_allclose(one.position_m, other.position_m, atol=1e-6)
    assert read_reconstruction(out).tracked.all()


class Watched(StandingPage):
    """Keeps in mind what it was told."""

    made: ClassVar[list["Watched"]] = []

    def __init__(self, **options):
        super().__init__(**options)
        self.said, self.shares, self.url, self.handed = [], [], None, None
        Watched.made.append(self)

    def open(self, title):
        self.url = super().open(title)
        return self.url

    def say(self, text):
        super().say(text)
        self.said.append(text)

    def progress(self, share):
        super().progress(share)
        self.shares.append(share)

    def hand_over(self):
        self.handed = super().hand_over()
        return self.handed


@pytest.fixture
def watched(monkeypatch):
    Watched.made = []
    monkeypatch.setattr("mbkf.viz.live.standing_page.StandingPage", Watched)
    return Watched.made


@pytest.mark.parametrize("address", ["127.0.0.1", "0.0.0.0"])
def test_who_is_to_stand_still_is_told_on_the_page_that_the_live_page_replaces(
    visit, tmp_path, capsys, monkeypatch, watched, address
):
    live = []

    class Page(LivePage):
        def __init__(self, *args, **options):
            super().__init__(*args, **options)
            live.append(self.url)

    monkeypatch.setattr("mbkf.viz.live.page.LivePage", Page)
    words = ["live", "--from", f"file:{visit}", "--mass", MASS_KG, "--speed", 0, "--view"]
    assert run([*words, "--view-address", address, "--out", tmp_path / "out"]) == 0
    told = capsys.readouterr().err.splitlines()
    (waiting,) = watched
    assert live == [waiting.url]
    assert [line for line in told if line.startswith("page: ")] == [f"page: {waiting.url}"]
    assert told[1] == f"page: {waiting.url}", "as soon as the stream is there"
    assert waiting.said == told[2:5]
    assert waiting.shares[-1] == 1.0
    assert bool(waiting.handed[1]) == (address == "0.0.0.0")


def test_a_page_that_nobody_is_scaled_at_is_closed(person, tmp_path, capsys, watched):
    before = set(threading.enumerate())
    words = ["live", "--from", f"file:{person.trial}", "--speed", 0, "--view"]
    assert run([*words, "--out", tmp_path / "out"]) == 2
    assert watched[0].url in capsys.readouterr().err
    assert watched[0].handed is None
    until(lambda: set(threading.enumerate()) <= before, threading.enumerate)


def test_a_known_subject_or_no_view_needs_no_waiting_page(person, visit, tmp_path, watched):
    words = ["live", "--speed", 0]
    known = [*words, "--from", f"file:{person.trial}", "--subject", person.subject, "--view"]
    assert run([*known, "--out", tmp_path / "known"]) == 0
    unseen = [*words, "--from", f"file:{visit}", "--mass", MASS_KG]
    assert run([*unseen, "--out", tmp_path / "unseen"]) == 0
    assert watched == []


def test_nobody_who_stands_still_ends_in_one_line(person, tmp_path, capsys):
    out = tmp_path / "out"
    assert run(["live", "--from", f"file:{person.trial}", "--speed", 0, "--out", out]) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith("mbkf: error: the source ended before a person was scaled: marker")
    assert json.loads((out / "live.json").read_text())["state"] == "no subject scaled"


@pytest.mark.parametrize(
    ("file", "options", "hint"),
    [("trial", ["--unlabelled"], "--protocol NAME"), ("trial_trc", [], "no force plates .* --mass KG")],
)
def test_what_the_stream_does_not_tell_is_asked_for(person, tmp_path, capsys, file, options, hint):
    words = ["live", "--from", f"file:{getattr(person, file)}", *options, "--out", tmp_path / "out"]
    assert run(words) == 2
    waiting, refusal = capsys.readouterr().err.splitlines()
    assert waiting.startswith("waiting for file:")
    assert re.match(f"mbkf: error: .*{hint}", refusal)
    assert not (tmp_path / "out").exists()


def test_ctrl_c_before_a_person_stood_still_leaves_a_report(visit, tmp_path):
    out = tmp_path / "out"
    words = ["live", "--from", f"file:{visit}", "--speed", "0.2", "--out", out]
    process = begun(words)
    until((out / "live.json").is_file)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 2
    assert errors.splitlines()[-1].startswith("mbkf: error: stopped before a person was scaled")
    assert json.loads((out / "live.json").read_text())["ended_by"] == "it was stopped"


def test_bad_input_is_refused(person, tmp_path, refused):
    subject, out = ["--subject", person.subject], ["--out", tmp_path / "out"]
    trial = ["--from", f"file:{person.trial}"]
    refused(["live", *subject, *out], "--from is missing")
    refused(["live", *trial, *subject, *out, "--mass", "70"], "--mass is for a person to scale")
    refused(["live", *trial, *subject, *out, "--protocol", "rizzoli"], "--protocol is for a person")
    refused(["live", *trial, *out, "--mass", "-1"], "--mass: '-1' is not a positive body mass in kg")
    refused(["live", *trial, *out, "--view", "--view-port", "70000"], "--view-port: '70000' is not a port")
    refused(["live", *trial, *out, "--protocol", "none"], "unknown protocol 'none'")
    refused(["live", *trial, *subject], "--out is missing")
    refused(["live", "--from", "kinect", *subject, *out], "unknown source 'kinect'")
    refused(["live", "--from", "file:", *subject, *out], "file:TRIAL")
    refused(["live", "--from", "file:none.c3d", *subject, *out], "none.c3d")
    refused(["live", *trial, *subject, *out, "--seconds", "0"], "--seconds: '0' is not a positive number")
    refused(["live", *trial, *subject, *out, "--speed", "-1"], "--speed: '-1' is not")
    refused(["live", *trial, *subject, *out, "--lag", "-1"], "--lag: '-1' is not")
    refused(["live", *trial, "--subject", "none.toml", *out], "none.toml")
    refused(["live", *trial, *subject, *out, "--preset", "none"], "unknown preset 'none'")
    refused(["live", "--recover", tmp_path / "nothing"], "no such file")
    file = tmp_path / "file"
    file.touch()
    refused(["live", *trial, *subject, "--out", file], "a file stands")


@pytest.mark.parametrize(
    ("options", "fragment"),
    [
        (["--speed", "0"], "--speed: '0' is not a positive number"),
        (["--jitter", "-1"], "--jitter: '-1' is not"),
        (["--loss", "1.5"], "--loss: '1.5' is not a number from 0 to 1"),
        (["--wait", "nan"], "--wait: 'nan' is not"),
        (["--port", "70000", "--to", "natnet"], "--port: '70000' is not a port"),
        (["--up", "q"], "up axis"),
    ],
)
def test_replay_refuses_bad_input(person, refused, options, fragment):
    words = options if "--to" in options else [*options, "--to", "lsl"]
    refused(["replay", person.trial, *words], fragment)


def test_replay_refuses_a_missing_file(refused):
    refused(["replay", "none.c3d", "--to", "lsl"], "none.c3d")


def test_a_missing_library_is_named(person, tmp_path, refused, monkeypatch):
    monkeypatch.setitem(sys.modules, "pylsl", None)
    words = ["live", "--from", "lsl", "--subject", person.subject, "--out", tmp_path / "out"]
    refused(words, "pip install pylsl (in a clone of mbkf also: pip install '.[lsl]')")


def test_a_first_signal_asks_and_a_second_breaks_off():
    before = signal.getsignal(signal.SIGINT)
    with stopped_by_signal() as stop:
        assert not stop.is_set()
        signal.raise_signal(signal.SIGTERM)
        assert stop.is_set()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before
