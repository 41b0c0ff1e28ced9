"""Exchanges of a static trial in a subject's report."""

from dataclasses import replace

from mbkf.io.static_exchanges import STATIC_EXCHANGED_KEY, static_exchanges
from tests.motions import reference_model, subject_of

PERSON = subject_of(reference_model())


def test_pairs_are_read_from_the_report():
    person = replace(PERSON, report={STATIC_EXCHANGED_KEY: [["RKNE", "LKNE"], ["RANK", "RHEE"]]})
    assert static_exchanges(person) == (("RKNE", "LKNE"), ("RANK", "RHEE"))


def test_most_persons_have_none():
    assert static_exchanges(PERSON) == ()
