"""Every foreseen error has a status and one sentence that any page can show."""

import errno
import json
import os

import pytest

from mbkf.app.failures import OF_SYSTEM, Refused, failed, failure
from mbkf.errors import FileFormatError, InvalidInput


@pytest.mark.parametrize(
    ("code", "status"),
    [(errno.ENOSPC, 507), (errno.EDQUOT, 507), (errno.ENAMETOOLONG, 400), (errno.ENOTDIR, 409), (errno.EISDIR, 409),
     (errno.EEXIST, 409), (errno.EACCES, 403), (errno.EROFS, 403), (errno.ENOENT, 404), (errno.EIO, 503)],
)  # fmt: skip
def test_errors_of_the_system(code, status):
    found, text = failure(OSError(code, os.strerror(code), "/lab/P1/walk.c3d"))
    assert found == status and text.startswith("walk.c3d: ") and "/lab" not in text
    assert OF_SYSTEM.get(code, (0, os.strerror(code)))[1] in text


def test_errors_of_this_package():
    assert failure(InvalidInput("two\n lines")) == (400, "two lines")
    assert failure(Refused(413, "too long")) == (413, "too long")
    assert failure(FileFormatError("x.toml", "damaged"))[0] == 400


@pytest.mark.parametrize("name", ["half \udcff letter", b"half \xff letter", "x" * 500, 3, None])
def test_any_name_becomes_a_reply(name):
    reply = failed(OSError(errno.EIO, "bad", name))
    assert reply.status_code == 503 and json.loads(reply.body)["trouble"]
    assert json.loads(failed(InvalidInput(f"half {name}")).body)["trouble"]
