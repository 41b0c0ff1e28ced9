"""Tasks turn whatever happens into an outcome with one line of reason."""

import errno
import os
import pickle

import pytest

from mbkf.errors import FileFormatError
from mbkf.study.batch.outcome import (
    Outcome,
    ReconstructTrial,
    ScalePerson,
    Status,
    failed,
    peak_memory_mb,
)
from mbkf.study.batch.plan import Files, Person, Trial
from mbkf.trial.preparation.settings import ReconstructSettings


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


def test_tasks_that_cannot_be_done_say_why(tmp_path):
    missing = tmp_path / "missing.c3d"
    person = Person("P", moving=(Files(missing),))
    for task in (
        ScalePerson(person, tmp_path),
        ReconstructTrial(Trial(person, missing), missing, tmp_path, ReconstructSettings()),
    ):
        found = pickle.loads(pickle.dumps(task))()
        assert found.status == Status.FAILED and "missing.c3d" in found.reason
        assert found.seconds >= 0.0 and found.subject is None
    assert list(tmp_path.iterdir()) == []


def test_memory_is_told_where_the_system_tells_it():
    peak = peak_memory_mb()
    assert peak is None if os.name != "posix" else 10.0 < peak < 1e5
