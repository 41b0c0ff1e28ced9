"""Writes fail in the folder that is named, from the one that is named on, or that one alone."""

import errno
import json
import subprocess
import sys

import pytest

from benchmarks.misuse.failing_writes import NotHere, failing_writes

PROGRAM = """
import ctypes, json, os, sys
from pathlib import Path
library, folder, at, lasting = sys.argv[1:]
shim = ctypes.CDLL(library)
shim.misuse_arm(folder.encode(), int(at), int(lasting))
found = []
for name in "abc":
    for place in (folder, folder + "-other"):
        try:
            Path(place, name).mkdir()
            found.append(0)
        except OSError as error:
            found.append(error.errno)
print(json.dumps([found, shim.misuse_disarm()]))
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    try:
        return failing_writes(tmp_path_factory.mktemp("library"))
    except NotHere as reason:
        pytest.skip(str(reason))


@pytest.mark.parametrize(
    ("at", "lasting", "fails"), [(0, True, [0, 0, 0]), (2, True, [0, 1, 1]), (2, False, [0, 1, 0])]
)
def test_the_write_that_is_named_fails(made, tmp_path, at, lasting, fails):
    inside, other = tmp_path / "in", tmp_path / "in-other"
    inside.mkdir()
    other.mkdir()
    words = [sys.executable, "-c", PROGRAM, made.library, f"{inside}", str(at), str(int(lasting))]
    done = subprocess.run(words, env=made.environment, capture_output=True, text=True, check=True)
    found, count = json.loads(done.stdout)
    assert [code == errno.ENOSPC for code in found[::2]] == [bool(one) for one in fails]
    assert found[1::2] == [0, 0, 0]
    assert count == 3
