"""What films need, or why their tests are left out."""

import os
import shutil

import pytest


@pytest.fixture(scope="module")
def filming():
    """A browser that films can start; none is started here, since one thread drives one at a time."""
    pytest.importorskip("playwright", reason="playwright is not installed: pip install '.[film]'")
    if not any(shutil.which(name) for name in ("chromium", "chromium-browser", "google-chrome")):
        message = "no chromium on this machine; install it (Debian: apt-get install chromium)"
        (pytest.fail if os.environ.get("CI") else pytest.skip)(message)
