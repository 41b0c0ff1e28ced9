"""Bands, verdicts, tables and the page on which the thesis and measurements stand side by side."""

import csv
import re
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.thesis_report.contents import OPEN, Band, Claim, Sheet, judged, redone
from benchmarks.thesis_report.figures import Drawing, axes
from benchmarks.thesis_report.page import Report, Texts

TEXTS = Texts(
    "Study <a>", "τ_1 followed.", ("7", "seeds"), "python -m benchmarks study", "Bands.", "Claims", "Black."
)


@pytest.mark.parametrize(
    ("value", "low", "high", "kept", "interval", "checks"),
    [
        (1.0, 0.5, 2.0, True, "0.5 … 2", 2),
        (3.0, -OPEN, 2.0, False, "≤ 2", 1),
        (3.0, 2.0, OPEN, True, "≥ 2", 1),
        (np.nan, 0.0, 1.0, False, "0 … 1", 2),
    ],
)
def test_bands_become_one_check_per_end(value, low, high, kept, interval, checks):
    band = Band("row", "name", value, low, high)
    found = band.checks(quick=False)
    assert (band.kept, band.interval, len(found)) == (kept, interval, checks)
    assert all(check.passed for check in found) == kept
    assert not any(check.bounded for check in band.checks(quick=True))
    assert all(check.bounded for check in Band("r", "n", value, low, high, "", False).checks(quick=True))


def test_verdicts():
    assert [judged(True), judged(False, True), judged(False)] == ["holds", "partly", "does not hold"]


def test_the_page_stands_alone(tmp_path):
    figure, (one,) = axes()
    one.plot([0.0, 1.0], [1.0, 0.0])
    sheet = Sheet(
        "t", "Title <1>", ("row", "x", "x ±", "x, thesis"), (("a", 1.25, 0.5, 2.0), ("b", np.inf, 0.1, 3.0))
    )
    empty = Sheet("e", "Not measured in a quick run", ("row", "x"), ())
    claims = [Claim("3.3", "τ_1 & more", "5 < 6", "partly")]
    bands = [Band("row", "kept", 1.0, 0.0, 2.0), Band("row", "broken", 3.0, 0.0, 2.0)]
    Report(TEXTS, False, bands, claims, [sheet, empty], [Drawing("3.7", "Noise", figure)]).write(tmp_path)
    text = (tmp_path / "index.html").read_text()
    assert "<h1>Study &lt;a&gt;</h1>" in text
    assert "1 of 2" in text
    assert "FAIL" in text
    assert "Title &lt;1&gt;" in text
    assert "Not measured" not in text
    assert "τ<sub>1</sub> &amp; more" in text
    assert "1.250 ± 0.5" in text
    assert not re.search(r"(src|href)=.https?:", text)
    assert "data:image/svg+xml;base64," in text
    rows = list(csv.reader((tmp_path / "t.csv").read_text().splitlines()))
    assert rows[1] == ["a", "1.25", "0.5", "2"]
    assert (tmp_path / "figure_3_7.svg").read_bytes().startswith(b"<?xml")


def test_the_page_of_another_source_names_it_and_counts_in_its_verdicts(tmp_path):
    texts = replace(TEXTS, source="paper")
    sheet = Sheet("t", "Errors", ("row", "x", "x, paper"), (("a", 1.0, 2.0),))
    verdicts = [redone(True), redone(False), redone(True), "cannot be had"]
    claims = [Claim("Figure 5", "An error", "Measured", verdict) for verdict in verdicts]
    Report(texts, False, [], claims, [sheet], []).write(tmp_path)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "<b>2 of 4</b>claims of the paper reproduced, 1 differ, 1 cannot be had" in page
    assert "<th>the paper</th>" in page
    assert "<td class='t n'>2.000</td>" in page
    assert "thesis" not in page


def test_figures_of_our_own_are_named_by_their_title():
    figure, _ = axes()
    assert Drawing("4.13", "Knee", figure).file == "figure_4_13.svg"
    assert Drawing("own", "Torque delay, causal", figure).file == "figure_own_torque_delay_causal.svg"
