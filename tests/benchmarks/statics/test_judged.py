"""What comes of a static trial with exchanged names."""

import sys
from pathlib import Path

import pytest

from benchmarks.statics import rows
from benchmarks.statics.captures import Static
from benchmarks.statics.judged import Judged, judged


def test_clean_and_crossed_statics_are_judged(monkeypatch):
    def few(protocol, worn, seed):
        names = [marker.name for marker in worn]
        a, b = names.index("RKNE"), names.index("LKNE")
        order = list(range(len(names)))
        order[a], order[b] = b, a
        return {"knees": order}

    monkeypatch.setattr(sys.modules[judged.__module__], "crossings", few)
    clean, crossed = judged(Static(Path(), "made plug_in_gait 4"))
    assert (clean.clean, clean.outcome) == (True, "kept")
    assert (crossed.clean, crossed.outcome) == (False, "mended")
    assert crossed.misfit == pytest.approx(clean.misfit, rel=1e-3)


@pytest.mark.parametrize(
    ("clean", "outcome", "passed"),
    [
        (True, "kept", [True, True]),
        (True, "renamed otherwise", [True, False]),
        (True, "refused", [True, False]),
        (False, "mended", [True, True]),
        (False, "refused", [True, True]),
        (False, "kept", [False, True]),
        (False, "renamed otherwise", [False, True]),
    ],
)
def test_silence_about_crossed_statics_and_accused_clean_ones_fail(clean, outcome, passed):
    found = [one for one in rows("shown on", [Judged("a", clean, outcome, 1.0)]) if one.bounded]
    assert [one.passed for one in found] == passed
