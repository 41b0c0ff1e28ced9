"""The laboratory's page and its files: exports change nothing; dropped files, norms and runs replace nothing."""

from __future__ import annotations

import http.cookiejar
import json
import shutil
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.leftovers import leftovers
from benchmarks.misuse.world import PERSONS, changed, digests, made_world
from mbkf.app.reports import NORMS_FILE
from mbkf.app.run_states import FAILED, FINISHED
from mbkf.app.server import AppServer
from mbkf.trial.export import RESULT_FORMATS

TRIAL = "trial"
READ = (
    "/session?",
    "/trial/look?",
    "/trial/report?",
    "/trial/recording?",
    "/report?language=en&",
    "/report/choices?",
)
DROPPED = (
    "P1/trial.c3d", "P1/../P1/trial.c3d", "P1//trial.c3d", "./P1/trial.c3d", "/P1/trial.c3d", "P2/../../outside.txt",
    "P1/trial.c3d/inside.c3d", "P1", "results/P1/trial/motion.h5", "results/summary.csv", "P1/TRIAL.C3D/..",
    "P1/linked.c3d", "P1/session.toml/x", "door/static.c3d", "", ".", "P1/\x00.c3d", "P1/" + "x" * 300 + ".c3d",
)  # fmt: skip
"""Names of dropped files that are there already, lead elsewhere, or are no names."""

FOREIGN = b"our own norms, by hand\n"
IN_THE_WAY = {"P1": "P1/subject.json", "P2": f"P2/{TRIAL}/motion.h5", "": "runs.json"}
"""Files of another program among the results, and the session whose run each is in the way of; "" for any."""

NOT_OURS, PATIENCE_S = "not written by mbkf", 120.0


@dataclass(frozen=True)
class Page:
    """A page's server and a browser's cookies."""

    server: AppServer
    opener: urllib.request.OpenerDirector

    def ask(self, path: str, body: bytes | None = None) -> tuple[int, bytes]:
        """Status and content of an answer.

        Args:
            path: With its query.
            body: What is sent; None for a request that only reads.
        """
        request = urllib.request.Request(f"http://127.0.0.1:{self.server.port}{path}", data=body)
        try:
            with self.opener.open(request, timeout=60.0) as answer:
                return int(answer.status), answer.read()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read()


def rows(context: Context) -> list[Check]:
    """All rows of the page's files."""
    world = made_world(context.out / "laboratory")
    root = context.out / "folder" / "study"
    shutil.copytree(world / "lab", root)
    shutil.copytree(world / "results", root / "results")
    (root / "P1" / "linked.c3d").symlink_to(world / "static.c3d")
    (root / "door").symlink_to(world)
    (root / NORMS_FILE).write_bytes(FOREIGN)
    before, outside = digests(root.parent), digests(world)
    with opened(root) as page:
        failed, refused_norms = read_everything(page), page.ask("/norms", b"{}")[0]
        wrong = [f"dropped as {name!r}: {fault}" for name in DROPPED if (fault := dropped(page, name))]
    ran_over, silent = run_over_foreign(world, context.out / "runs")
    lost = [*changed(before, root.parent), *changed(outside, world)]
    made = sorted(set(digests(root.parent)) - set(before))
    stray = [name for name in made if not name.startswith("study/")]
    return [
        Check("files changed or lost", len(lost), 0, "<="),
        Check("files made outside its folder, or left unfinished", len([*stray, *leftovers(root)]), 0, "<="),
        Check("exports and pages that did not work", len(failed), 0, "<="),
        Check("dropped files without a sentence", len(wrong), 0, "<="),
        Check("norms over a file of another program: status", refused_norms, 400, ">="),
        Check("runs over files of another program: files changed or lost", len(ran_over), 0, "<="),
        Check("runs over files of another program: without a sentence", len(silent), 0, "<="),
        *(information(line, 1.0) for line in (*lost, *stray, *failed, *wrong, *ran_over, *silent)),
    ]


@contextmanager
def opened(root: Path) -> Iterator[Page]:
    """The page of a folder, with a browser that is let in; served until the block ends."""
    server = AppServer(root)
    try:
        cookies = urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar())
        page = Page(server, urllib.request.build_opener(cookies))
        page.opener.open(server.url).close()
        yield page
    finally:
        server.close()


def run_over_foreign(world: Path, root: Path) -> tuple[list[str], list[str]]:
    """Runs sessions whose results have files of another program in their way; files lost, and silent sessions.

    Args:
        world: The laboratory.
        root: The page's folder, to be made.
    """
    shutil.copytree(world / "lab", root)
    for name in IN_THE_WAY.values():
        path = root / "results" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(FOREIGN)
    before = digests(root)
    with opened(root) as page:
        silent = [person for person in PERSONS if not _says_so(page, person)]
    return changed(before, root), silent


def _says_so(page: Page, person: str) -> bool:
    """Runs a session to its end; true where it then says that mbkf did not write a file."""
    page.ask(f"/run?session={person}&do=start", b"")
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        _, content = page.ask(f"/session?session={person}")
        run = json.loads(content)["run"]
        if run is not None and run["state"] in {FINISHED, FAILED}:
            return NOT_OURS in content.decode("utf-8")
        time.sleep(0.1)
    return False


def read_everything(page: Page) -> list[str]:
    """Reads all pages and exports of every session's trial; those that did not work.

    Args:
        page: The page.
    """
    failed = []
    for person in PERSONS:
        names = urllib.parse.urlencode({"session": person, "trial": TRIAL})
        paths = [f"{path}{names}" for path in READ]
        paths += [f"/trial/export?{names}&to={to}" for to in RESULT_FORMATS]
        paths += [f"/report/curves?{names}&as={kind}" for kind in ("csv", "parquet")]
        answers = [page.ask(path) for path in paths]
        failed += [
            f"{path}: {status} {content[:150].decode('utf-8', 'replace')}"
            for path, (status, content) in zip(paths, answers, strict=True)
            if status != 200 or not content
        ]
    return failed


def dropped(page: Page, name: str) -> str:
    """Drops a file and returns the fault of the answer: empty where it is a sentence, or the file was stored.

    Args:
        page: The page.
        name: The file's name.
    """
    status, content = page.ask(f"/put?file={urllib.parse.quote(name)}", b"another capture")
    if status == 200:
        return ""
    if status >= 500 and status != 507:
        return f"status {status}"
    return "" if len(content.split()) > 3 else f"status {status} without a sentence"
