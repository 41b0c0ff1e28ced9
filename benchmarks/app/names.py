"""A session in which every name that a file can carry is an attempt to run a script in the page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.app.pages_of import every_page
from benchmarks.app.visit import Visit
from benchmarks.checks import Check
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import AnalogChannel, Capture, CaptureEvent
from mbkf.io.session import SessionNotes, TrialNotes, write_session
from mbkf.io.trc import write_trc
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.synth import synthesise

HIT = "window.hit=1"
EVIL = (
    f"<img src=x onerror={HIT}>",
    f'"><script>{HIT}</script>',
    f"</script><script>{HIT}</script>",
    f"javascript:{HIT}//",
    "{{scripts}}",
    f"' onmouseover='{HIT}",
)

FILE = "<img src=x onerror=window.hit=1>&'{{words}}"
"""What a file's name can hold: no slash."""

ACTIVE = """() => [
  window.hit === undefined ? 0 : 1,
  [...document.querySelectorAll("*")].filter((e) => [...e.attributes].some((a) => a.name.startsWith("on"))).length,
  [...document.querySelectorAll("img, object, embed, script[src], a[href^='javascript:']")].length,
  [...document.scripts].filter((e) => e.textContent.trim().startsWith("window.hit")).length,
  [...document.querySelectorAll("iframe")].filter((e) => !e.closest("dialog")).length,
]"""
"""A script that was put in as text does not run, but stands there; the page's own frames are in its dialogs."""


def evil_session(folder: Path, seed: int = 0) -> Path:
    """Trials whose names of files, markers, analog channels and events are attempts; returns the session.

    One trial for each attempt is run. As many more are excluded, for a reason that is one; a table of points (TRC) has
    them all as names.
    """
    session = folder / FILE
    session.mkdir(parents=True)
    person = synthesise_subject(seed)
    _, made = synthesise("walk", seconds=2.5, seed=seed, subject=person)
    for k, text in enumerate(EVIL):
        write_c3d(_named(made.trial, text), session / f"{k} {FILE}.c3d")
        write_c3d(made.trial, session / f"out {k} {FILE}.c3d")
    write_trc(_all_named(made.trial).markers, session / f"points {FILE}.trc")
    write_c3d(made.static, session / "static.c3d")
    stated = {f"out {k} {FILE}": TrialNotes(excluded=text) for k, text in enumerate(EVIL)}
    write_session(SessionNotes(name=EVIL[1], trials=stated), session / "session.toml")
    return session


def injection_rows(user: Visit) -> list[Check]:
    """Active elements in all pages of such a session, once it was run.

    Args:
        user: A visit that shows it.
    """
    opened, found = 0, 0.0
    for _, frames in every_page(user, every_trial=True):
        opened += 1
        found += sum(active(frame) for frame in frames)
    least = 4.0 + 2.0 * len(EVIL)
    return [
        Check("names that are scripts: pages looked at", float(opened), least, ">="),
        Check("names that are scripts: active elements in all pages", found, 0.0, "<="),
    ]


def active(frame: Any) -> float:
    """How many elements of a frame could act that the page did not make."""
    return float(sum(frame.evaluate(ACTIVE)))


def _named(capture: Capture, text: str) -> Capture:
    """The capture with one more marker, an analog channel and an event of that name."""
    markers = capture.markers
    extra = markers.positions_m[:, :1] + 0.3
    positions = np.concatenate([markers.positions_m, extra], axis=1)
    return replace(
        capture,
        markers=replace(markers, names=(*markers.names, text), positions_m=positions),
        analog=(*capture.analog, AnalogChannel(text, np.zeros(len(positions)), "V", markers.rate_hz)),
        events=(CaptureEvent(text, "Right", 0.5),),
    )


def _all_named(capture: Capture) -> Capture:
    """The capture with one more marker for each attempt."""
    for text in EVIL:
        capture = _named(capture, text)
    return capture
