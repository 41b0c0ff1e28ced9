"""What the page asks of a live run becomes options of `mbkf live`, and nothing that it says becomes another one."""

import pytest

from mbkf.app.live_command import live_offer, live_options, recording_folder, recording_options
from mbkf.app.workspace import Workspace
from mbkf.cli.main import build_parser
from mbkf.errors import InvalidInput
from tests.studies import study

LSL = {"source": "lsl", "stream": "QTM", "body": "standing"}


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    return study(tmp_path_factory.mktemp("lab") / "lab", persons=2)


@pytest.fixture
def workspace(lab):
    return Workspace(lab)


def parsed(words):
    """As `mbkf live` takes them."""
    return build_parser(["live"]).parse_args(["live", *words, "--out=x"])


def test_a_stream_of_any_name_is_one_word(workspace):
    for name in ("QTM", "--out=/etc", "-h", "a b", "$(reboot)", "é 1"):
        args = parsed(live_options(workspace, "P1", {**LSL, "stream": name}))
        assert (args.source, args.stream, args.out, args.subject) == ("lsl", name, "x", None)


def test_motive_is_asked_at_its_address(workspace):
    said = {"source": "natnet", "server": " 192.168.1.10", "local": "--out=y", "body": "standing"}
    args = parsed(live_options(workspace, "P1", said))
    assert (args.source, args.server, args.local, args.out) == ("natnet", "192.168.1.10", "--out=y", "x")


def test_a_group_that_motive_streams_to_is_named(workspace):
    said = {"source": "natnet", "server": "a", "local": "b", "port": "1512", "multicast": "239.1.2.3"}
    args = parsed(live_options(workspace, "P1", {**said, "body": "standing"}))
    assert (args.port, args.multicast) == (1512, "239.1.2.3")


@pytest.mark.parametrize(
    ("said", "source", "local"),
    [
        (
            {"source": "qualisys", "host": "10.0.0.2", "port": "22232 "},
            "qualisys:10.0.0.2:22232",
            "127.0.0.1",
        ),
        ({"source": "vicon", "host": " lab", "port": ""}, "vicon:lab", "127.0.0.1"),
        ({"source": "udp", "port": "15200", "local": "0.0.0.0"}, "udp:15200", "0.0.0.0"),
        ({"source": "udp", "port": "", "local": ""}, "udp", "127.0.0.1"),
    ],
)
def test_other_streams_are_followed_at_their_places(workspace, said, source, local):
    args = parsed(live_options(workspace, "P1", {**said, "body": "standing"}))
    assert (args.source, args.local, args.out) == (source, local, "x")


def test_a_capture_of_the_session_is_played(workspace, lab):
    args = parsed(live_options(workspace, "P1", {"source": "file", "trial": "walk1", "body": "standing"}))
    assert args.source == f"file:{lab / 'P1' / 'walk1.c3d'}" and args.forces is None


def test_what_is_stated_of_the_person_is_taken(workspace, lab):
    captures = [
        {"name": "walk1", "file": "walk1.c3d", "kind": "walk"},
        {"name": "static", "file": "static.c3d", "kind": "static"},
    ]
    assert live_offer(workspace, "P2") == {"captures": captures, "subject": False, "mass_kg": None}
    file = lab / "P2" / "session.toml"
    file.write_text('[trial.walk1]\nexcluded = "stumbled"\n')
    assert live_offer(workspace, "P2")["captures"] == captures[1:]
    file.write_text('mass_kg = 71.5\nprotocol = "reference36"\n')
    args = parsed(live_options(workspace, "P2", LSL))
    assert (args.mass, args.protocol) == (71.5, "reference36")
    assert live_offer(workspace, "P2")["mass_kg"] == 71.5
    file.unlink()
    assert parsed(live_options(workspace, "P2", LSL)).mass is None


def test_the_scaled_body_is_taken_where_there_is_one(workspace, lab):
    with pytest.raises(InvalidInput, match="no body of this session is scaled"):
        live_options(workspace, "P1", {**LSL, "body": "subject"})
    scaled = workspace.place("P1") / "subject.toml"
    scaled.parent.mkdir(parents=True)
    scaled.write_text("")
    args = parsed(live_options(workspace, "P1", {**LSL, "body": "subject"}))
    assert (args.subject, args.mass) == (str(scaled), None)
    args = parsed(live_options(workspace, "P1", {"source": "xsens", "port": "9764", "body": "subject"}))
    assert (args.source, args.subject) == ("xsens:9764", str(scaled))
    assert live_offer(workspace, "P1")["subject"] is True
    scaled.unlink()


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ([], "needs a source and a body"),
        ({}, "choose a stream, a camera system or a capture"),
        ({"source": "file:/etc/passwd", "body": "standing"}, "choose a stream, a camera system or a capture"),
        ({"source": "lsl", "body": "standing"}, "choose a stream"),
        ({"source": "vicon", "host": " ", "body": "standing"}, "address of the camera system's computer is"),
        ({"source": "vicon", "host": "lab", "port": "0", "body": "standing"}, "'0' is not a port"),
        ({"source": "udp", "port": "65536", "body": "standing"}, "'65536' is not a port"),
        ({"source": "xsens", "port": "²", "body": "standing"}, "'²' is not a port"),
        ({"source": "xsens", "port": "", "body": "standing"}, "need the session's scaled body"),
        ({"source": "natnet", "server": "1.2.3.4", "body": "standing"}, "the local address is missing"),
        ({"source": "file", "trial": "../P2/walk1", "body": "standing"}, "no capture"),
        ({"source": "file", "trial": 3, "body": "standing"}, "short text"),
        ({"source": "lsl", "stream": "x" * 501, "body": "standing"}, "short text"),
        ({"source": "lsl", "stream": "a\0b", "body": "standing"}, "short text"),
        ({"source": "lsl", "stream": "QTM", "body": "mine"}, "choose the scaled body"),
    ],
)
def test_what_is_not_possible_is_refused(workspace, said, why):
    with pytest.raises(InvalidInput, match=why):
        live_options(workspace, "P1", said)


def test_an_unknown_session_is_refused(workspace):
    for ask in (live_offer, lambda *two: live_options(*two, LSL), lambda *two: recording_folder(*two, "now")):
        with pytest.raises(InvalidInput, match="no session"):
            ask(workspace, "../P1")


def test_a_recording_has_a_folder_of_its_own(workspace, lab):
    assert recording_folder(workspace, "P1", "now") == workspace.place("P1") / "live-now"
    capture = lab / "P1" / "live-now.c3d"
    capture.write_bytes((lab / "P1" / "walk1.c3d").read_bytes())
    (workspace.place("P1") / "live-now-2").mkdir(parents=True)
    assert recording_folder(workspace, "P1", "now").name == "live-now-3", "neither a capture's nor a result's"
    capture.unlink()


def test_a_stream_is_recorded_as_a_new_capture_of_the_session(workspace, lab):
    wanted = {**LSL, "record": "on"}
    assert recording_options(workspace, "P1", LSL, "now") == []
    first = lab / "P1" / "recorded-now.c3d"
    assert parsed(recording_options(workspace, "P1", wanted, "now")).record == str(first)
    first.write_bytes(b"damaged, and still not to be replaced")
    (workspace.place("P1") / "recorded-now-2").mkdir(parents=True)
    args = parsed(recording_options(workspace, "P1", wanted, "now"))
    assert args.record == str(lab / "P1" / "recorded-now-3.c3d") and not args.overwrite
    first.unlink()


def test_sensors_are_not_recorded_as_a_capture(workspace):
    with pytest.raises(InvalidInput, match="no markers"):
        recording_options(workspace, "P1", {"source": "xsens", "record": "on"}, "now")
