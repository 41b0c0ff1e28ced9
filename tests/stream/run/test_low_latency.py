"""Threads take turns quickly inside, and as they did before afterwards, whatever happens."""

import subprocess
import sys

import pytest

from mbkf.stream.run.low_latency import SWITCH_S, low_latency


def test_the_interpreter_is_as_it_was_afterwards():
    before = sys.getswitchinterval()
    with pytest.raises(KeyError), low_latency():
        assert sys.getswitchinterval() == pytest.approx(SWITCH_S)
        raise KeyError
    assert sys.getswitchinterval() == before


COUNTS = """
import gc, sys
from mbkf.stream.run.low_latency import low_latency
if sys.argv[1:]:
    gc.freeze()
before = gc.get_freeze_count()
with low_latency():
    inside = gc.get_freeze_count()
print(before > 0, inside > 0, inside == before, gc.get_freeze_count() == before)
"""


@pytest.mark.parametrize(
    ("own", "counts"), [([], "False True False True"), (["frozen"], "True True True True")]
)
def test_objects_are_frozen_inside_unless_the_program_froze_its_own(own, counts):
    words = [sys.executable, "-c", COUNTS, *own]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == counts
