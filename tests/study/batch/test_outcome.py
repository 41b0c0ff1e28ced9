"""Whatever happens becomes an outcome with one line of reason."""

import errno
import os

import pytest

from mbkf.errors import FileFormatError
from mbkf.study.batch.outcome import AnotherPerson, Outcome, Status, failed, peak_memory_mb


@pytest.mark.parametrize(
    "error, told",
    [
        (FileFormatError("a.c3d", "is\nno C3D"), "a.c3d: is no C3D"),
        (
            OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "a/motion.h5"),
            "No space left on device: a/motion.h5",
        ),
        (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), "No space left on device"),
        (ValueError("odd"), "unforeseen ValueError: odd (a bug in mbkf; please report it)"),
        (MemoryError(), "unforeseen MemoryError: MemoryError (a bug in mbkf; please report it)"),
    ],
)
def test_errors_are_told_in_one_line(error, told):
    assert failed(error) == Outcome(Status.FAILED, told)


def test_a_trial_of_another_person_is_marked():
    assert failed(AnotherPerson("walk.c3d: longer")) == Outcome(
        Status.FAILED, "walk.c3d: longer", another_person=True
    )


def test_memory_is_told_where_the_system_tells_it():
    peak = peak_memory_mb()
    assert peak is None if os.name != "posix" else 10.0 < peak < 1e5
