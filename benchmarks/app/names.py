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
from mbkf.io.records import Capture, CaptureEvent
from mbkf.io.session import SessionNotes, TrialNotes, write_session
from mbkf.pipelines.synth import synthesise
from mbkf.synthesis.person import synthesise_subject

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
]"""


def evil_session(folder: Path) -> Path:
    """Trials whose names of files, markers and events, and what is stated of them, are attempts; the session."""
    session = folder / FILE
    session.mkdir(parents=True)
    person = synthesise_subject(0)
    _, made = synthesise("walk", seconds=2.5, seed=0, subject=person)
    for k, text in enumerate(EVIL):
        write_c3d(_named(made.trial, text), session / f"{k} {FILE}.c3d")
    write_c3d(made.static, session / "static.c3d")
    stated = {f"{k} {FILE}": TrialNotes(excluded=text) for k, text in enumerate(EVIL) if k % 2}
    write_session(SessionNotes(name=EVIL[1], trials=stated), session / "session.toml")
    return session


def injection_rows(user: Visit) -> list[Check]:
    """Active elements in all pages of such a session, once it was run.

    Args:
        user: A visit that shows it.
    """
    found = sum(active(frame) for _, frames in every_page(user) for frame in frames)
    return [Check("names that are scripts: active elements in all pages", found, 0.0, "<=")]


def active(frame: Any) -> float:
    """How many elements of a frame could act that the page did not make."""
    return float(sum(frame.evaluate(ACTIVE)))


def _named(capture: Capture, text: str) -> Capture:
    """The capture with one more marker, and events, of that name."""
    markers = capture.markers
    extra = markers.positions_m[:, :1] + 0.3
    positions = np.concatenate([markers.positions_m, extra], axis=1)
    return replace(
        capture,
        markers=replace(markers, names=(*markers.names, text), positions_m=positions),
        events=(CaptureEvent(text, "Right", 0.5),),
    )
