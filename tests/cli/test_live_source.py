"""``--from`` names a source and, for some, its port or address."""

import argparse
import socket

import pytest

from mbkf.cli.live_source import add_source_options, source_of
from mbkf.errors import MbkfError
from mbkf.io.c3d_write import write_c3d
from tests.captures import made_capture


def source(text, *options):
    parser = argparse.ArgumentParser()
    parser.add_argument("--from", dest="source")
    add_source_options(parser)
    made = source_of(parser.parse_args(["--from", text, *options]))
    made.close()
    return made


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def test_udp_listens_at_its_port():
    port = free_port()
    assert source(f"udp:{port}").port == port


def test_qualisys_has_a_computer_and_a_base_port():
    assert source("qualisys")._place == ("127.0.0.1", 22222, False)
    assert source("qualisys:lab:2000", "--over-udp")._place == ("lab", 2000, True)
    assert source("qualisys", "--control")._control == ""


def test_vicon_has_a_computer_and_a_port():
    assert source("vicon")._place == ("127.0.0.1", 801) and not source("vicon")._pull
    made = source("vicon:lab:44801", "--pull", "--person", "Anna", "--up", "y")
    assert (made._place, made._pull, made._person, made._up) == (("lab", 44801), True, "Anna", "y")


def test_xsens_listens_at_its_port_for_a_person():
    port = free_port()
    made = source(f"xsens:{port}", "--character", "2", "--up", "y")
    assert (made.port, made._character, made._up) == (port, 2, "y")


def test_plates_of_a_file_are_those_of_a_stream_without_any(tmp_path):
    file = tmp_path / "lab.c3d"
    write_c3d(made_capture(5), file)
    for text, in_plate_axes in ((f"udp:{free_port()}", False), ("natnet", True)):
        made = source(text, "--plates", str(file))
        assert len(made._geometry.plates) == 2 and made._local is in_plate_axes
    with pytest.raises(MbkfError, match=r"missing\.c3d"):
        source("natnet", "--plates", str(tmp_path / "missing.c3d"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("udp:70000", "write udp:15100"),
        ("vicon:lab:x", "write vicon:lab:801"),
        ("xsens:mvn", "write xsens:9763"),
        ("udp:abc", "write udp:15100"),
        ("qualisys:lab:x", "write qualisys:lab:22222"),
        ("lsl:3", "unknown source 'lsl:3'"),
        ("serial", "unknown source"),
        ("file:", "names no file"),
    ],
)
def test_anything_else_is_refused(text, words):
    with pytest.raises(MbkfError, match=words):
        source(text)
