"""Pages in Spanish of sessions made from shared captures: every page that a clinician opens, and failures."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.app.pages_of import every_page
from benchmarks.app.visit import Visit, browser, served, visit
from benchmarks.clinic.words.texts import texts_of
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.viz.report.document import report_page

CAPTURES: Mapping[str, tuple[str, ...]] = {
    "S1": ("rehazenter_walk/2014001_ST_static.c3d", "rehazenter_walk/2014001_C1_01.c3d"),
    "S2": ("gaitalytics_walk/overground_fullbody_4plates.c3d",),
    "S3": ("french_walk_no_pelvis/marche281.c3d",),
    "S4": (
        "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d",
        "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d",
    ),
}
"""Sessions: a walk with a late clock, one without a static trial, one that no mass is known of, two persons."""

BROKEN = "S5"
"""A session with a text file named as a C3D and a C3D that is cut short."""

SPANISH = "es"

FAILING = (
    "session?session=zz", "trial/report?session=S1&trial=zz", "report?session=S3", "report?session=S1&norms=zz",
    "trial/look?session=S3&trial=m31", "marker_set?session=S5", "live/page", "report/curves?session=S3", "nowhere",
    "session?session=%00",
)  # fmt: skip
"""Requests of the page's server that fail."""

READ = """() => {
  const found = [], spoken = ["title", "aria-label", "placeholder", "alt"];
  const silent = (one) => one.closest("script, style, code, [translate=no]");
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
  for (let node = walk.currentNode; node; node = walk.nextNode()) {
    if (node.nodeType === Node.TEXT_NODE) {
      if (node.textContent.trim() && !silent(node.parentElement)) found.push(node.textContent.trim());
    } else if (!silent(node)) {
      for (const name of spoken) if (node.getAttribute(name)) found.push(node.getAttribute(name));
    }
  }
  const rows = "ul.flags li, table.reasons tbody tr, ul.problems li, details.reasons li, section#trials li";
  return { texts: found, problems: [...document.querySelectorAll(rows)].map((one) => one.textContent.trim()) };
}"""
"""Script that returns the texts of a page, those that only a reader of the screen speaks included, and its problems."""

_FETCH = """async (path) => {
  const answer = await fetch(path), text = await answer.text();
  try { return JSON.parse(text).trouble ?? text; } catch { return text; }
}"""

_DONE = "() => !document.querySelector('.run progress') && document.querySelector('button.main:enabled')"


class Read(NamedTuple):
    """A page that was read.

    Attributes:
        page: Its name.
        texts: Its texts.
        problems: The texts of them that state problems: reasons and remarks.
    """

    page: str
    texts: list[str]
    problems: list[str]


def read_pages(data: Path, out: Path) -> tuple[list[Read], set[str], list[bool]]:
    """Texts of every page in Spanish, names that are in no language, and whether "64,2" and "64.2" were taken.

    Args:
        data: The shared captures.
        out: An empty folder.
    """
    lab = out / "lab"
    names = _sessions(data, lab)
    found: list[Read] = []
    with browser() as made, served(lab) as server:
        user = visit(made, server.url)
        user.page.evaluate("remember('mbkf language', 'es')")
        for session in (*CAPTURES, BROKEN):
            user.page.goto(server.url.split("?")[0] + f"?session={session}")
            user.wait("table")
            user.click("button.main")
            user.page.wait_for_timeout(1500)
            user.page.wait_for_function(_DONE, timeout=180e3)
            found += _read_session(user, session)
        found.append(_failures(user))
        numbers = _numbers(user, server.url.split("?")[0])
        troubles = list(user.troubles)
    found.append(Read("errors of scripts", troubles, []))
    found += [_report(folder) for folder in sorted((lab / "results").glob("**/motion.h5"))]
    return found, names, numbers


def _sessions(data: Path, lab: Path) -> set[str]:
    """Sessions with short names of their files; returns all names."""
    names = {BROKEN}
    for session, files in CAPTURES.items():
        (lab / session).mkdir(parents=True)
        for k, file in enumerate(files):
            name = f"m{session[1]}{k + 1}"
            shutil.copy(data / file, lab / session / f"{name}.c3d")
            names |= {session, name}
    (lab / BROKEN).mkdir()
    whole = (data / CAPTURES["S2"][0]).read_bytes()
    (lab / BROKEN / "m51.c3d").write_bytes(whole[:3000])
    (lab / BROKEN / "m52.trc").write_text("no capture at all\n")
    return names | {"m51", "m52", "marker_set.toml"}


def _read_session(user: Visit, session: str) -> Iterator[Read]:
    """The page of a session and every page behind it, where it has results."""
    if not user.page.locator("td .buttons").count():
        yield _read(session, user.page)
        return
    for name, frames in every_page(user, close="Cerrar"):
        for k, frame in enumerate(frames[-1:] if name != "session" else frames):
            yield _read(f"{session} {name} {k}", frame)


def _read(name: str, frame: Any) -> Read:
    """The texts of a page, and of them the reasons and remarks: elements of lists or rows of tables."""
    frame.wait_for_load_state()
    found = frame.evaluate(READ)
    return Read(name, found["texts"], found["problems"])


def _failures(user: Visit) -> Read:
    texts = [user.page.evaluate(_FETCH, path) for path in FAILING]
    put = (
        "async () => (await (await fetch('put?file=../x.c3d', { method: 'POST', body: 'x' })).json()).trouble"
    )
    run = "async () => (await (await fetch('run?session=zz', { method: 'POST' })).json()).trouble"
    return Read("failures", [*texts, user.page.evaluate(put), user.page.evaluate(run)], [])


def _numbers(user: Visit, address: str) -> list[bool]:
    """True for each way of writing 64.2 that the field of the mass takes as 64.2."""
    found = []
    for text in ("64,2", "64.2"):
        user.page.goto(address + "?session=S3")
        user.wait("input[name=mass_kg]")
        for written in ("70", text):
            field = user.page.locator("input[name=mass_kg]")
            field.fill(written)
            field.blur()
            user.page.wait_for_timeout(800)
        asked = "async () => (await (await fetch('session?session=S3')).json()).notes.mass_kg"
        found.append(
            user.page.evaluate(asked) == 64.2 and user.page.input_value("input[name=mass_kg]") == "64,2"
        )
    return found


def _report(file: Path) -> Read:
    """The report on a trial as the command line writes it."""
    result = read_reconstruction(file.parent)
    page = report_page(result, read_summary(file.parent), language=SPANISH)
    return Read(f"report {file.parent.name}", list(texts_of(page)), [])
