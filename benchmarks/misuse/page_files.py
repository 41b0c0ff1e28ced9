"""The laboratory's page and its files: exports change nothing, dropped files and norms replace nothing."""

from __future__ import annotations

import http.cookiejar
import shutil
import urllib.error
import urllib.parse
import urllib.request
from dataclasses import dataclass

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.leftovers import leftovers
from benchmarks.misuse.world import PERSONS, changed, digests, made_world
from mbkf.app.reports import NORMS_FILE
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
    server = AppServer(root)
    try:
        cookies = urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar())
        page = Page(server, urllib.request.build_opener(cookies))
        page.opener.open(server.url).close()
        failed, refused_norms = read_everything(page), page.ask("/norms", b"{}")[0]
        wrong = [f"dropped as {name!r}: {fault}" for name in DROPPED if (fault := dropped(page, name))]
    finally:
        server.close()
    lost = [*changed(before, root.parent), *changed(outside, world)]
    made = sorted(set(digests(root.parent)) - set(before))
    stray = [name for name in made if not name.startswith("study/")]
    return [
        Check("files changed or lost", len(lost), 0, "<="),
        Check("files made outside its folder, or left unfinished", len([*stray, *leftovers(root)]), 0, "<="),
        Check("exports and pages that did not work", len(failed), 0, "<="),
        Check("dropped files without a sentence", len(wrong), 0, "<="),
        Check("norms over a file of another program: status", refused_norms, 400, ">="),
        *(information(line, 1.0) for line in (*lost, *stray, *failed, *wrong)),
    ]


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
