"""Secrets of pages: in no process's words or variables, no log, no file that others may read, no history, no referrer.

Each command that serves a page with a token runs with secrets that carry a mark. Its browser is a script that notes its
words and waits; meanwhile all processes are looked at. Then Chromium opens the same address.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.app.visit import until
from benchmarks.checks import Check, Context, information
from benchmarks.misuse.marked_secrets import FIRST, MARK
from benchmarks.misuse.world import made_world
from mbkf.errors import MbkfError

COMMANDS: Mapping[str, tuple[str, ...]] = {
    "app": ("app", "{world}/study"),
    "protocol edit": ("protocol", "edit", "{world}/static.c3d", "--out", "{out}/new.toml"),
    "view": ("view", "{world}/result", "--address", "127.0.0.1"),
}
"""Commands that serve a page in a browser."""

BROWSER = """#!/bin/sh
printf '%s' "$1" > {folder}/asked.part
mv {folder}/asked.part {folder}/asked
while [ ! -e {folder}/looked ]; do sleep 0.05; done
"""
CHROMIUM = """
import json, sys
from playwright.sync_api import sync_playwright
program, profile, address = sys.argv[1:]
seen = []
with sync_playwright() as playwright:
    made = playwright.chromium.launch_persistent_context(
        profile, executable_path=program, args=["--no-sandbox"], headless=True
    )
    page = made.pages[0]
    page.on("request", lambda request: seen.append(request.headers.get("referer", "")))
    answer = page.goto(address)
    page.wait_for_timeout(2000)
    page.reload()
    page.wait_for_timeout(500)
    print(json.dumps({"referers": seen, "address": page.url, "title": page.title(),
                      "length": page.evaluate("history.length")}))
    made.close()
"""
PATIENCE_S = 40.0


@dataclass
class Leaks:
    """Places where secrets were found.

    Attributes:
        command: The command that served the page.
        processes: Processes whose words or variables hold one.
        printed: Lines of its standard output and error, kept in files, that hold one.
        readable: Files that other users may read and that hold one.
        history: Files of the browser's profile that hold the token, and referrers that hold any.
        trouble: The reason why the page did not open; "" where it did.
    """

    command: str
    processes: list[str] = field(default_factory=list)
    printed: list[str] = field(default_factory=list)
    readable: list[str] = field(default_factory=list)
    history: list[str] = field(default_factory=list)
    trouble: str = ""


def rows(context: Context) -> list[Check]:
    """All rows of secrets."""
    if not Path("/proc/self/cmdline").exists():
        return [information("left out: this system does not show the words of processes under /proc", 0.0)]
    world = made_world(context.out / "laboratory")
    found = [
        leaks(name, words, world, context.out / f"{k}") for k, (name, words) in enumerate(COMMANDS.items())
    ]
    kinds = {
        "in the words and variables of processes": [one for leak in found for one in leak.processes],
        "in what is printed": [one for leak in found for one in leak.printed],
        "in files that others may read": [one for leak in found for one in leak.readable],
        "in the browser's history and referrers": [one for leak in found for one in leak.history],
    }
    trouble = [f"{leak.command}: {leak.trouble}" for leak in found if leak.trouble]
    return [
        *(Check(f"secrets {name}", len(ones), 0, "<=") for name, ones in kinds.items()),
        Check("pages that did not open", len(trouble), 0, "<="),
        *(information(one, 1.0) for ones in (*kinds.values(), trouble) for one in ones),
    ]


def leaks(name: str, words: tuple[str, ...], world: Path, folder: Path) -> Leaks:
    """Runs a command that serves a page, opens the page, and looks for its secrets.

    Args:
        name: Its name.
        words: Its words.
        world: The laboratory.
        folder: Of its home, its browser and what it prints, to be made.
    """
    home = folder / "home"
    home.mkdir(parents=True)
    home.chmod(0o755)
    script = folder / "browser"
    script.write_text(BROWSER.format(folder=folder), "utf-8")
    script.chmod(0o755)
    given = [word.format(world=world, out=folder) for word in words]
    found = Leaks(name)
    variables = {**os.environ, "HOME": str(home), "BROWSER": f"{script} %s", "TMPDIR": str(home)}
    with (
        (folder / "printed").open("wb") as printed,
        subprocess.Popen(
            [sys.executable, "-m", "benchmarks.misuse.marked_secrets", *given],
            env=variables, stdin=subprocess.DEVNULL, stdout=printed, stderr=subprocess.STDOUT,
        ) as process,
    ):  # fmt: skip
        try:
            until(lambda: (folder / "asked").exists() or process.poll() is not None, PATIENCE_S)
            found.processes += list(_in_processes())
            found.readable += list(_readable(home))
            _visit(found, (folder / "asked").read_text("utf-8"), folder)
        except (MbkfError, OSError, subprocess.SubprocessError) as error:
            found.trouble = str(error)
        finally:
            (folder / "looked").touch()
            process.send_signal(signal.SIGINT)
            try:
                process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                found.trouble = f"goes on for {PATIENCE_S:g} s after Ctrl-C"
    found.printed += [
        f"{name} prints {line[:80]!r}"
        for line in (folder / "printed").read_text("utf-8").splitlines()
        if MARK in line
    ]
    if list(home.glob("mbkf*")):
        found.readable.append(f"{name} leaves {next(home.glob('mbkf*')).name} in the home folder")
    return found


def _in_processes() -> Iterator[str]:
    for place in Path("/proc").glob("[0-9]*"):
        for kind in ("cmdline", "environ"):
            with suppress(OSError):
                content = (place / kind).read_bytes()
                if MARK.encode() in content:
                    yield f"{kind} of {content.split(bytes(1))[0].decode('utf-8', 'replace')}"


def _readable(folder: Path) -> Iterator[str]:
    """Files that other users may read and that hold a secret."""
    for path in folder.rglob("*"):
        if (
            path.is_file()
            and path.stat().st_mode & (stat.S_IRGRP | stat.S_IROTH)
            and MARK.encode() in path.read_bytes()
        ):
            yield f"{path.name} may be read by others"


def _visit(found: Leaks, address: str, folder: Path) -> None:
    """Opens the address that the browser was asked for, and looks at what the browser keeps."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        found.trouble = "no browser is here: install chromium"
        return
    profile = folder / "profile"
    done = subprocess.run(
        [sys.executable, "-c", CHROMIUM, program, profile, address],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        found.trouble = done.stderr.strip()[-300:]
        return
    told = done.stdout
    if MARK in told:
        found.history.append(f"{found.command}: {re.sub(r'[0-9A-Za-z_-]{22}', '…', told)[:200]}")
    if '"title": ""' in told or "Refused" in told:
        found.trouble = told[:200]
    for path in profile.rglob("*"):
        if path.is_file() and "Cookies" not in path.name and FIRST.encode() in path.read_bytes():
            found.history.append(f"{found.command}: {path.relative_to(profile)}")
