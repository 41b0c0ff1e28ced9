"""What many names share and what means nothing is taken off, and nothing else."""

import pytest

from mbkf.marker_sets.affixes import without_affixes

MEANING = {"r", "l", "knee", "lat"}


def cores(names):
    return [core.core for core in without_affixes(names, lambda word: word.lower() in MEANING)]


@pytest.mark.parametrize(
    ("names", "left"),
    [
        (["Anna:RKNE", "Anna:LKNE"], ["RKNE", "LKNE"]),
        (["a:b:C7", "T10"], ["C7", "T10"]),
        (["Q_HeadL", "Q_HeadR"], ["HeadL", "HeadR"]),
        (["251112_KUO_LASI", "251112_KUO_RASI"], ["LASI", "RASI"]),
        (["r_knee_study", "L_knee_study"], ["r_knee", "L_knee"]),
        (["R_heel", "R_toe"], ["R_heel", "R_toe"]),
        (["knee_a", "knee_b"], ["knee_a", "knee_b"]),
        (["x_lat", "y_lat"], ["x_lat", "y_lat"]),
        (["one_a", "two_b"], ["one_a", "two_b"]),
        (["alone_C7"], ["alone_C7"]),
        (["Anna:"], ["Anna:"]),
        ([], []),
    ],
)
def test_shared_words_without_meaning_are_taken_off(names, left):
    assert cores(names) == left


def test_names_that_lost_the_same_belong_together():
    found = without_affixes(
        [f"n{i}_study" for i in range(5)] + [f"m{i}" for i in range(5)], lambda word: False
    )
    assert len({core.affixes for core in found}) == 2
    assert [core.name for core in found][:2] == ["n0_study", "n1_study"]
