"""The table of checks: worst first, a tick for what noise explains, numbers with units, text escaped."""

from mbkf.io.findings import Finding, not_judged
from mbkf.io.verdict import Reason, Verdict
from mbkf.viz.report.checks import findings_table

FOUND = (
    Finding("clocks", 1.0, 2.0, "ms", 8.0, "inside", "plates are 1 ms late"),
    not_judged("gains", "%", 5.0, "needs <two> plates"),
    Finding("mass", 30.4, 1.0, "%", 5.0, "outside", "weigh anew"),
    Finding("soles", -26.0, 12.0, "mm", 30.0, "doubtful", "below"),
)


def test_the_worst_stands_first():
    page = findings_table(FOUND, Verdict())
    places = [page.index(f"<td>{name}</td>") for name in ("mass", "soles", "clocks", "gains")]
    assert places == sorted(places)


def test_signs_and_numbers():
    page = findings_table(FOUND, Verdict())
    for cells in (
        "<td>mass</td><td>✗</td><td>30.4 %</td><td>± 2 %</td><td>5 %</td><td>weigh anew</td>",
        "<td>clocks</td><td>✓</td><td>1 ms</td><td>± 4 ms</td><td>8 ms</td>",
        "<td>gains</td><td>–</td><td>–</td><td>–</td><td>5 %</td><td>needs &lt;two&gt; plates</td>",
    ):
        assert cells in page
    assert page.count("✓") == 1


def test_nothing_checked_shows_nothing():
    assert findings_table((), Verdict()) == ""


def test_what_a_reason_states_is_not_repeated():
    clock = Finding("clocks of markers and plates", 21.5, 1.0, "ms", 12.0, "outside", "plates are late")
    known = Verdict.of([Reason("trunk_loads", "look", "clocks of markers and plates +21.5 ms", "-", "-")])
    assert "plates are late" in findings_table((clock,), Verdict())
    assert "plates are late" not in findings_table((clock,), known)
    assert "see the reasons of the verdict" in findings_table((clock,), known)
