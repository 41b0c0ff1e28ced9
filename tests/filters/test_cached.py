"""Values that are made when first asked for."""

import gc
import weakref

import pytest

from mbkf.filters.cached import Cached


def test_a_value_is_made_once_and_only_when_asked_for():
    made = []
    value = Cached(lambda: made.append(1) or len(made))
    assert made == []
    assert value() == 1
    assert value() == 1
    assert made == [1]


def test_none_is_a_value_like_any_other():
    made = []
    value = Cached(lambda: made.append(1))
    assert value() is None
    assert value() is None
    assert made == [1]


def test_what_it_was_made_from_is_let_go():
    class Source:
        def told(self):
            return "told"

    source = Source()
    gone, value = weakref.ref(source), Cached(source.told)
    assert value() == "told"
    del source
    gc.collect()
    assert gone() is None


def test_a_failure_is_no_value():
    asked = []

    def fails_at_first():
        asked.append(1)
        if len(asked) == 1:
            raise ValueError("not yet")
        return "made"

    value = Cached(fails_at_first)
    with pytest.raises(ValueError, match="not yet"):
        value()
    assert value() == "made"
