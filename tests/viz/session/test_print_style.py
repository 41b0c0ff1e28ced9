"""Margins of printed pages: patient, date, laboratory and page, whatever letters a name holds."""

from dataclasses import replace

from mbkf.io.laboratory import Laboratory
from mbkf.io.visit import Visit
from mbkf.viz.session.print_style import MOST_LETTERS, page_margins
from tests.study.session.sessions import session


def test_every_page_names_patient_date_laboratory_and_number():
    one = replace(session(), patient="P 01", visit=Visit("2025-03-31"))
    found = page_margins(one, Laboratory("Ours"), "Report")
    assert r'@top-left { content: "P\00002001"; }' in found
    assert r'@top-center { content: "2025\00002d03\00002d31"; }' in found
    assert '@top-right { content: "Ours"; }' in found
    assert '@bottom-right { content: counter(page) " / " counter(pages); }' in found
    assert '@top-left { content: "session' in page_margins(session(), Laboratory(), "R")


def test_a_name_ends_neither_text_nor_style():
    evil = '"; } </style><script>\\'
    found = page_margins(replace(session(), patient=evil), Laboratory("x" * 200), "R")
    assert "<" not in found and found.count('"') == 2 * 5 and "script" in found
    assert found.count("x") == MOST_LETTERS - 1
