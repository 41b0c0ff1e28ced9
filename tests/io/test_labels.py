"""Labels become unambiguous, and what was renamed is told."""

from hypothesis import given
from hypothesis import strategies as st

from mbkf.io.labels import unique_labels, without_subject


@given(labels=st.lists(st.sampled_from(["A", "A_2", "A_3", "B", ""]), max_size=8))
def test_labels_are_unique_and_the_first_of_each_keeps_its_name(labels):
    notes = []
    found = unique_labels(labels, notes)
    assert len(set(found)) == len(found) == len(labels)
    assert [found[labels.index(label)] for label in labels] == labels
    assert bool(notes) == (len(set(labels)) < len(labels))


def test_what_was_renamed_is_told():
    notes = []
    assert unique_labels(["A", "B", "A", "A_2"], notes) == ["A", "B", "A_3", "A_2"]
    assert notes == ["labels that occur more than once were renamed: A → A_3"]


def test_one_subjects_name_is_taken_off_and_several_are_kept():
    assert without_subject(["Anna:LASI", "Anna:RASI", "*3"]) == ["LASI", "RASI", "*3"]
    assert without_subject(["Anna:LASI", "Bea:LASI"]) == ["Anna:LASI", "Bea:LASI"]
    assert without_subject(["Anna:LASI", "RASI"]) == ["Anna:LASI", "RASI"]
