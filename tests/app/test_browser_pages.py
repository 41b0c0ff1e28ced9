"""Every page of a session in a real browser: nothing that a name carries acts, and nobody is shut out."""

import os
from dataclasses import replace
from importlib.util import find_spec

import pytest

from benchmarks.app.accessible import findings
from benchmarks.app.names import EVIL, active
from benchmarks.app.pages_of import every_page
from benchmarks.app.visit import visit
from mbkf.app.server import AppServer
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.records import AnalogChannel, CaptureEvent
from mbkf.io.session import SessionNotes, TrialNotes, write_session
from tests.studies import runs_here, study


@pytest.fixture(scope="module")
def shown(browser, tmp_path_factory):
    """A session that was run, whose names of a marker, a channel, an event and the person are attempts."""
    lab = tmp_path_factory.mktemp("pages") / "lab"
    session = study(lab, trials=1) / "P1"
    trial = read_capture(session / "walk1.c3d")
    names = trial.markers.names
    (session / "walk1.c3d").unlink()
    write_c3d(
        replace(
            trial,
            markers=replace(trial.markers, names=(*names[:-1], EVIL[0])),
            analog=(AnalogChannel(EVIL[1], trial.markers.positions_m[:, 0, 0], "V", trial.markers.rate_hz),),
            events=(CaptureEvent(EVIL[0], "Right", 0.5),),
        ),
        session / "walk1.c3d",
    )
    (session / "out.c3d").write_bytes((session / "walk1.c3d").read_bytes())
    write_session(
        SessionNotes(name=EVIL[0], trials={"out": TrialNotes(excluded=EVIL[1])}), session / "session.toml"
    )
    with runs_here():
        server = AppServer(lab, workers=1)
        user = visit(browser, server.url)
        user.wait("tbody tr")
        user.click("button.main")
        user.wait("text=Done in")
        yield user
        server.close()


@pytest.fixture(scope="module")
def pages(shown):
    """Of every page: how many names acted, and what axe-core finds; None where it is not installed."""
    checked = find_spec("axe_playwright_python") is not None
    return {
        name: (
            sum(map(active, frames)),
            [one for frame in frames for one in findings(frame)] if checked else None,
        )
        for name, frames in every_page(shown)
    }


def test_names_do_not_act_in_any_page(shown, pages):
    found = {name: acted for name, (acted, _) in pages.items()}
    assert found == dict.fromkeys(found, 0.0) and len(found) == 6
    assert EVIL[0] == shown.page.locator("input[name=name]").input_value()
    assert shown.troubles == []


def test_every_page_is_accessible(pages):
    if find_spec("axe_playwright_python") is None:
        message = "axe-core is not installed: pip install '.[test]'"
        (pytest.fail if os.environ.get("CI") else pytest.skip)(message)
    assert {name: faults for name, (_, faults) in pages.items()} == {name: [] for name in pages}
