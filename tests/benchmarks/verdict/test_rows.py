"""Rows of the benchmark of verdicts: shares of words, and wrong results under "use"."""

from benchmarks.verdict.rows import faulty_rows, right_rows
from benchmarks.verdict.trials import Judged

NAN = float("nan")


def judged(word, angle_deg=NAN, torque=NAN):
    return Judged("walk 3", word, angle_deg, torque, word)


def bounded(rows):
    return {one.name: (one.value, one.passed) for one in rows if one.bounded}


def test_right_trials_are_counted_by_word():
    found = bounded(right_rows("shown on", [judged("use")] * 8 + [judged("look")] * 2))
    assert found == {
        "right trials (shown on, 10) under do not use": (0.0, True),
        "right trials (shown on, 10) under look": (20.0, False),
    }


def test_only_wrong_results_under_use_count():
    trials = [
        judged("use", 12.0, 0.0),
        judged("use", 2.0, 0.1),
        judged("look", 30.0, 2.0),
        judged("do not use", 0.0, 0.0),
    ]
    ((name, (share, passed)),) = bounded(faulty_rows("shown on", trials)).items()
    assert name == "wrong results under use of 4 faulty trials (shown on)"
    assert (share, passed) == (25.0, False)
    assert judged("use", 0.0, 0.4).wrong_in_use and not judged("use", NAN, NAN).wrong_in_use
