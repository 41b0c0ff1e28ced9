"""`mbkf protocol`: what its commands print, write and refuse."""

import contextlib
import json
import re
import threading
import urllib.request
import webbrowser
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from mbkf.cli import (
    protocol_check,
    protocol_edit,
    protocol_guess,
    protocol_import,
    protocol_list,
    protocol_show,
)
from mbkf.cli.main import main
from mbkf.cli.protocol import SUBCOMMANDS
from mbkf.model.protocol import load_protocol, protocol_names
from mbkf.model.protocol_file import write_protocol
from tests.osim_files import marker_set, osim_4, skeleton
from tests.waiting import PATIENCE_S

MARKERS = [
    ("R.ASIS", "pelvis", (0.01, 0.02, 0.13), True),
    ("Top", "torso", (0.0, 0.65, 0.0), False),
    ("R.Thigh", "femur_r", (0.05, -0.2, 0.03), False),
    ("Rack", "walker", (0.0, 0.0, 0.0), False),
]


@pytest.fixture
def opened(monkeypatch):
    """What a browser would have been asked to open."""
    found = []
    monkeypatch.setattr(webbrowser, "open", found.append)
    return found


def call(capsys, *words):
    code = main(["protocol", *(str(word) for word in words)])
    return code, capsys.readouterr().out


def test_every_command_of_the_group_is_a_module():
    modules = (protocol_list, protocol_show, protocol_guess, protocol_import, protocol_check, protocol_edit)
    assert tuple(module.__name__.rpartition("_")[2] for module in modules) == SUBCOMMANDS


def test_list(capsys):
    code, out = call(capsys, "list")
    assert code == 0
    assert all(name in out for name in protocol_names())
    code, out = call(capsys, "list", "--json")
    rows = {row["name"]: row for row in json.loads(out)}
    assert set(rows) == set(protocol_names())
    assert set(rows["gait2354"]) == {"name", "title", "markers", "body", "source"}
    assert rows["gait2354"]["markers"] == len(load_protocol("gait2354").markers)


def test_show_prints_writes_and_opens(capsys, tmp_path, opened):
    code, out = call(capsys, "show", "plug_in_gait", "--out", tmp_path / "set.html")
    assert code == 0
    assert all(marker.name in out for marker in load_protocol("plug_in_gait").markers)
    assert "RASI" in (tmp_path / "set.html").read_text(encoding="utf-8")
    assert opened == [(tmp_path / "set.html").as_uri()]
    assert call(capsys, "show", "plug_in_gait", "--no-browser")[0] == 0
    assert len(opened) == 1


def test_show_tells_doubts_and_what_is_ignored(capsys, tmp_path, opened):
    shipped = load_protocol("plug_in_gait")
    doubtful = replace(shipped.markers[0], probability=0.5, alternatives=(("head", 0.4),))
    protocol = replace(
        shipped, markers=(doubtful, *shipped.markers[1:]), ignored={"ghost": "mirror"}, source="a visit"
    )
    write_protocol(protocol, tmp_path / "mine.toml")
    _, out = call(capsys, "show", tmp_path / "mine.toml", "--no-browser")
    for told in ("50 %, or head 40 %", "ignored: ghost: mirror", "source: a visit"):
        assert told in out
    assert opened == []


def test_guess_writes_a_set_that_explains_the_capture(capsys, person, tmp_path):
    words = ("guess", person.static, "--trial", person.trial, "--out", tmp_path / "mine.toml")
    code, out = call(capsys, *words)
    assert code == 0
    assert "marker set inferred" in out
    found = load_protocol(tmp_path / "mine.toml")
    assert found.name == "mine"
    truth = load_protocol("reference36").match([marker.name for marker in found.markers])
    right = [m for m in found.markers if m.name in truth and truth[m.name].segment == m.segment]
    assert len(right) > 30
    assert call(capsys, "check", tmp_path / "mine.toml", person.static)[0] == 0


def test_guess_needs_a_capture(tmp_path, refused):
    refused(["protocol", "guess", "--out", tmp_path / "mine.toml"], "static trial")


def test_import_writes_what_it_prints(capsys, tmp_path):
    (tmp_path / "model.osim").write_text(osim_4(skeleton(), MARKERS), encoding="utf-8")
    code, out = call(capsys, "import", tmp_path / "model.osim")
    assert code == 0
    assert [path.name for path in tmp_path.iterdir()] == ["model.osim"]
    assert "--out FILE.toml writes the set" in out
    code, out = call(capsys, "import", tmp_path / "model.osim", "--out", tmp_path / "mine.toml")
    assert code == 0
    for told in ("Top: torso → head", "ignored: Rack", "3 markers"):
        assert told in out
    assert [marker.name for marker in load_protocol(tmp_path / "mine.toml").markers] == [
        "R.ASIS",
        "Top",
        "R.Thigh",
    ]
    (tmp_path / "set.xml").write_text(marker_set(MARKERS, 3), encoding="utf-8")
    assert "common full-body model" in call(capsys, "import", tmp_path / "set.xml")[1]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (osim_4(skeleton(), []), "holds no marker"),
        ("name;x;y;z", "not XML"),
        ("<html><body>404</body></html>", "not an OpenSim model"),
    ],
)
def test_import_refuses_in_one_line_and_writes_nothing(content, reason, tmp_path, refused):
    (tmp_path / "model.osim").write_text(content, encoding="utf-8")
    refused(
        ["protocol", "import", tmp_path / "model.osim", "--out", tmp_path / "mine.toml"], "model.osim", reason
    )
    refused(["protocol", "import", tmp_path / "none.osim", "--out", tmp_path / "mine.toml"], "no such file")


def test_names_that_no_set_can_have_are_refused_before_any_work(tmp_path, refused, person):
    (tmp_path / "model.osim").write_text(osim_4(skeleton(), MARKERS), encoding="utf-8")
    refused(["protocol", "import", tmp_path / "model.osim", "--out", tmp_path / "mine.xml"], "ends in .toml")
    refused(["protocol", "edit", person.static, "--out", tmp_path / "mine.txt"], "ends in .toml")
    refused(["protocol", "edit", person.static, "--out", tmp_path / "m.toml", "--port", "99999"], "99999")
    refused(["protocol", "show", "plug_in_gate"], "plug_in_gait")
    refused(["protocol", "check", tmp_path / "none.toml", person.static], "cannot be read")
    refused(["protocol"], "COMMAND")


def test_check_says_whether_a_set_explains_a_capture(capsys, person, tmp_path):
    code, out = call(capsys, "check", "reference36", person.static)
    assert (code, out.splitlines()[-1]) == (0, "verdict: ok")
    code, out = call(capsys, "check", "gait2354", person.static)
    assert (code, out.splitlines()[-1]) == (1, "verdict: bad")
    shipped = load_protocol("reference36")
    write_protocol(replace(shipped, markers=shipped.markers[:-4]), tmp_path / "mine.toml")
    code, out = call(capsys, "check", tmp_path / "mine.toml", person.static)
    assert (code, out.splitlines()[-1]) == (0, "verdict: doubtful")
    for told in ("knows 32 of 36", "unknown: ", "segments without a marker", "mm RMS"):
        assert told in out


@pytest.mark.parametrize("words", [("save", "done"), ("done",)])
def test_edit_serves_until_its_page_is_done(words, person, tmp_path, capsys, monkeypatch):
    def visit(file):
        url = re.search(r'href="([^"]+)"', Path(urlsplit(file).path).read_text())[1]

        def speak():
            with urllib.request.urlopen(url) as entered:
                cookie = entered.headers["Set-Cookie"].partition(";")[0]
            address = f"ws{url[4:].partition('?')[0]}frames"
            with connect(address, additional_headers={"Cookie": cookie}) as page:
                page.recv(PATIENCE_S)
                for word in words:
                    page.send(json.dumps({"do": word, "choices": {"RASI": {"ignored": "loose"}}}))
                    with contextlib.suppress(ConnectionClosed):  # the server may be gone before it answers
                        page.recv(PATIENCE_S)

        threading.Thread(target=speak).start()

    monkeypatch.setattr(webbrowser, "open", visit)
    monkeypatch.setenv("HOME", str(tmp_path))
    code, out = call(capsys, "edit", person.static, "--out", tmp_path / "mine.toml")
    assert code == 0
    assert re.search(r"http://127\.0\.0\.1:\d+/\n", out) and "token" not in out
    if "save" in words:
        assert "35 markers, 1 left out" in out
        assert dict(load_protocol(tmp_path / "mine.toml").ignored) == {"RASI": "loose"}
    else:
        assert "nothing was saved" in out
        assert not (tmp_path / "mine.toml").exists()
