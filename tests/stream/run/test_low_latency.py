"""Threads take turns quickly inside, and as they did before afterwards, whatever happens."""

import gc
import sys

import pytest

from mbkf.stream.run.low_latency import SWITCH_S, low_latency


def test_the_interpreter_is_as_it_was_afterwards():
    before = sys.getswitchinterval()
    with pytest.raises(KeyError), low_latency():
        assert sys.getswitchinterval() == pytest.approx(SWITCH_S)
        assert gc.get_freeze_count() > 0
        raise KeyError
    assert sys.getswitchinterval() == before
    assert gc.get_freeze_count() == 0
