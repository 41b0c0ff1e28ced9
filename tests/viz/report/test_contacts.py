"""The report's contacts: a bar and a row for each, by how it is known, and curves of other parts' forces."""

import re
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import Reason, Verdict
from mbkf.viz.report.contacts import MOST_ROWS, contact_chart, contact_section, support_cells
from tests.motions import assert_near
from tests.recordings import RAIL, SEAT, leaning_walk, walk


def rows_of(text):
    return [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(<td>.*?)</tr>", text)]


def test_every_contact_has_its_row():
    r = leaning_walk()
    rows = rows_of(contact_section(r))
    assert len(rows) == len(r.contacts)
    hand = next(row for row in rows if row[0] == "Right hand")
    peak = np.linalg.norm([40.0, 10.0, 180.0])
    assert hand[1:5] == [
        f"{r.times_s[RAIL.start]:.2f}",
        f"{r.times_s[RAIL.stop - 1]:.2f}",
        f"{peak:.0f}",
        "40",
    ]
    assert hand[5] == "estimated from the motion"
    assert {row[0] for row in rows} == {"Right foot", "Left foot", "Pelvis", "Right hand"}


def test_forces_that_no_contact_explains_have_a_table():
    assert "no contact explains" not in contact_section(walk())
    seat = UnexplainedLoad(1.2, 9.8, (0.0, 0.0, 590.0), 8.0, 0.82, "", "a seat")
    reason = Reason("trunk_loads", "look", "unexplained force", "left out", "a seat")
    known = replace(walk(), unexplained=(seat,), verdict=Verdict.of([reason]))
    assert rows_of(contact_section(known))[-1][-1] == "", "stated among the reasons"
    text = contact_section(replace(walk(), unexplained=(seat,), verdict=Verdict()))
    assert rows_of(text)[-1] == ["upward", "1.20", "9.80", "590", "16", "82", "a seat"]
    assert rows_of(text[text.index("no contact explains") :]) == [rows_of(text)[-1]]


def test_bars_stand_when_parts_bear_and_tell_how_that_is_known():
    r = leaning_walk()
    svg = ET.fromstring(contact_chart(r, r.contacts))
    assert [e.text for e in svg.iter("text") if e.get("class") == "name"] == [
        "right foot", "left foot", "pelvis", "right hand",
    ]  # fmt: skip
    styles = [e.get("class") for e in svg.iter("rect")]
    assert {"r measured", "l measured", "l estimated", "m estimated", "r estimated"} == set(styles)
    assert len(styles) == len(r.contacts)
    per_second = 930.0 / (r.times_s[-1] - r.times_s[0])
    (seat,) = (e for e in svg.iter("rect") if e.get("class") == "m estimated")
    assert_near(float(seat.get("x")), 60.0 + r.times_s[SEAT.start] * per_second, 0.06)
    assert_near(float(seat.get("width")), (SEAT.stop - 1 - SEAT.start) / r.rate_hz * per_second, 0.06)
    assert float(seat.get("y")) == 44.0


def test_only_what_occurs_is_in_the_key():
    text = contact_section(leaning_walk())
    assert 'class="estimated"' in text and 'class="shared"' not in text
    shared = replace(walk(), foot_source=np.where(walk().foot_source > 0, 2, 0))
    assert "share of a plate under both feet" in contact_section(shared)
    assert "other parts than the feet" not in contact_section(shared)


def test_parts_that_ever_bear_have_curves_with_bands_while_they_do():
    """The horizontal components are told forward and to the left, so their size stays."""
    r = leaning_walk()
    rows = support_cells(r)
    assert [[cell.title for cell in row] for row in rows] == [
        [f"{part}, {way}" for way in ("vertical", "fore-aft", "sideways")] for part in ("Pelvis", "Hand")
    ]
    vertical, ahead, aside = (cell.curves["r"] for cell in rows[1])
    assert_near(vertical[0][RAIL], 180.0, 1e-9)
    assert_near(np.hypot(ahead[0], aside[0])[RAIL], np.hypot(40.0, 10.0), 1e-9)
    assert_near(vertical[1][RAIL], 20.0, 1e-9)
    assert np.isnan(np.delete(vertical[1], np.r_[RAIL])).all()
    assert list(rows[0][0].curves) == [""] and list(rows[1][0].curves) == ["r"]


def test_many_contacts_are_folded():
    r = walk()
    flicker = np.tile((np.arange(r.frames) // 6 % 2)[:, None], (1, 2))
    many = replace(r, foot_source=flicker)
    assert len(many.contacts) > MOST_ROWS
    assert f"<summary>All {len(many.contacts)} contacts</summary>" in contact_section(many)
    assert "<summary>" not in contact_section(r)


def test_a_body_on_which_nothing_is_known_to_act_is_told_so():
    r = walk()
    none = replace(r, foot_source=np.zeros((r.frames, 2), int))
    assert "No load on the body is known" in contact_section(none)
