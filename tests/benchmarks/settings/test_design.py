"""Designs: the full product, few combinations with every pair, and single changes of the base."""

from itertools import combinations, product

from benchmarks.settings.design import BASE, FACTORS, every_combination, every_pair, single_changes


def test_the_few_show_every_pair_of_choices():
    few, words = every_pair(), list(FACTORS.values())
    assert len(few) < 0.1 * len(every_combination())
    for i, j in combinations(range(len(words)), 2):
        assert {(one[i], one[j]) for one in few} == set(product(words[i], words[j]))


def test_single_changes_leave_all_else():
    changes = list(single_changes())
    assert len(changes) == sum(len(words) - 1 for words in FACTORS.values())
    assert all(sum(a != b for a, b in zip(one, BASE, strict=True)) == 1 for one in changes)
    assert not any("stable" in one for one in [*single_changes("stable"), *every_combination("stable")])
