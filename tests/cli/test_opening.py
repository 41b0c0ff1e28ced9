"""No secret stands in a browser's command line, in a log, in its history, or in a Referer."""

import os
import re
import shutil
import stat
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from mbkf.cli import opening as module
from mbkf.cli.opening import PREFIX, open_page, printed_address
from mbkf.viz.server import PageServer
from tests.viz.browsing import PATIENCE_S
from tests.viz.conftest import FLAGS

TOKEN = "the-secret-of-this-page"

FAKE_BROWSER = """#!/bin/sh
# Writes its own command line, as every user of the computer can read it, and the file that it is to open.
tr '\\0' ' ' < /proc/$$/cmdline > {log}.part
echo >> {log}.part
cat "$(echo "$1" | sed 's,^file://,,')" >> {log}.part
mv {log}.part {log}
"""


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path


@pytest.fixture
def server():
    made = PageServer("<title>reached</title>", hear=str, token=TOKEN)
    yield made
    made.close()


def left(folder):
    return [path.name for path in folder.iterdir() if path.name.startswith(PREFIX)]


def test_the_file_is_for_its_user_alone_and_is_removed_after_use(server, home, monkeypatch):
    asked = []
    monkeypatch.setattr(module.webbrowser, "open", asked.append)
    open_page(server)
    (address,) = asked
    file = Path(urlsplit(address).path)
    assert address.startswith("file://") and file.parent == home
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    text = file.read_text(encoding="utf-8")
    assert TOKEN not in text + address and "no-referrer" in text
    subprocess.run([sys.executable, "-c", VISIT, re.search(r'href="([^"]+)"', text)[1]], check=True)
    assert left(home) == []


VISIT = "import sys, urllib.request; urllib.request.urlopen(sys.argv[1]).read()"


def test_without_a_home_the_file_lies_among_temporary_ones(server, home, monkeypatch):
    asked = []
    monkeypatch.setattr(module.webbrowser, "open", asked.append)
    monkeypatch.setenv("HOME", str(home / "none"))
    open_page(server)
    file = Path(urlsplit(asked[0]).path)
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    server.entrance(file.unlink)


def test_the_token_is_printed_for_a_person_at_a_terminal_only(server, monkeypatch):
    assert printed_address(server, browser=False) == server.url
    assert TOKEN not in printed_address(server, browser=True)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert printed_address(server, browser=True) == server.url


@pytest.mark.skipif(not Path("/proc/self/cmdline").exists(), reason="needs /proc")
def test_a_browser_s_command_line_holds_no_secret(home, tmp_path):
    log, browser = tmp_path / "seen", tmp_path / "browser"
    browser.write_text(FAKE_BROWSER.format(log=log))
    browser.chmod(0o755)
    words = [sys.executable, "-m", "mbkf", "app", str(tmp_path / "lab")]
    environment = os.environ | {"BROWSER": f"{browser} %s", "HOME": str(home)}
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=environment) as process:
        printed = process.stdout.readline() + process.stdout.readline()
        while not log.exists():
            assert process.poll() is None
        process.terminate()
        printed += process.stdout.read()
        assert process.wait() == 0
    line, _, text = log.read_text().partition("\n")
    ticket = re.search(r"ticket=([\w-]+)", text)[1]
    assert "file://" in line and ticket not in line + printed and "token" not in line + printed
    assert left(home) == [], "an unused file goes with its server"


def test_a_real_browser_keeps_no_secret(server, home, tmp_path):
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("no chromium on this machine")
    from playwright.sync_api import sync_playwright

    opened, profile, seen = [], tmp_path / "profile", []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module.webbrowser, "open", opened.append)
        open_page(server)
    with sync_playwright() as playwright:
        context = playwright.chromium.launch_persistent_context(
            str(profile), executable_path=chromium, args=FLAGS
        )
        page = context.new_page()
        page.set_default_timeout(1e3 * PATIENCE_S)
        page.on("request", lambda request: seen.append(request.all_headers().get("referer", "")))
        page.goto(opened[0])
        page.wait_for_url(server.url.partition("?")[0])
        assert page.title() == "reached" and page.evaluate("document.cookie") == ""
        context.close()
    assert left(home) == [] and not any(TOKEN in referer or "ticket" in referer for referer in seen)
    kept = b"".join(path.read_bytes() for path in profile.rglob("History*") if path.is_file())
    assert b"127.0.0.1" in kept and TOKEN.encode() not in kept
