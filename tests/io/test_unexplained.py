"""An unexplained load in words and numbers."""

import pytest

from mbkf.errors import InvalidInput
from mbkf.io.unexplained import UnexplainedLoad


def load(vector, **other):
    return UnexplainedLoad(1.2, 9.8, vector, 8.0, 0.82, **other)


@pytest.mark.parametrize(
    ("vector", "words"),
    [
        ((0.0, 0.0, 590.0), "upward"),
        ((100.0, 0.0, -590.0), "downward"),
        ((300.0, 0.0, 0.0), "horizontal"),
        ((200.0, 200.0, 50.0), "horizontal"),
        ((300.0, 0.0, 300.0), "obliquely upward"),
        ((0.0, -300.0, -300.0), "obliquely downward"),
    ],
)
def test_direction(vector, words):
    assert load(vector).direction == words


def test_sentence():
    found = load((0.0, 0.0, 590.0), hint="a seat").sentence
    assert found == "unexplained force 590 N upward (82 % of body weight) from 1.20 to 9.80 s: a seat"


def test_sentence_while_it_goes_on():
    assert load((0.0, 0.0, 590.0), hint="a seat").sentence_now == (
        "unexplained force 590 N upward (82 % of body weight): a seat"
    )


def test_size():
    assert load((3.0, 4.0, 12.0)).force_n == pytest.approx(13.0)


def test_an_unknown_cause_is_refused():
    with pytest.raises(InvalidInput, match="unknown cause 'ghost'"):
        load((0.0, 0.0, 1.0), cause="ghost")
