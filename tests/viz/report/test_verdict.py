"""The report's first lines: the word, the parts, and the reasons of parts that are shown."""

from dataclasses import replace

from mbkf.io.verdict import Reason, Verdict
from mbkf.trial.results.summary import summarise
from mbkf.viz.report.document import report_page
from mbkf.viz.report.verdict import verdict_banner
from tests.recordings import walk

LEG = Reason("left_leg", "do not use", "knee <57°> beyond", "turned over", "check names")
NO_ARM = Reason("right_arm", "do not use", "nothing of it", "usual posture", "add markers", shown=False)


def test_a_right_trial_has_one_word_and_no_reasons():
    found = verdict_banner(Verdict())
    assert 'class="verdict good"' in found and ">use<" in found and "All reasons" not in found


def test_reasons_stand_with_part_word_finding_meaning_and_remedy():
    found = verdict_banner(Verdict.of([LEG, NO_ARM]))
    assert 'class="verdict bad"' in found
    for cell in ("left leg", "do not use", "knee &lt;57°&gt; beyond", "turned over", "check names"):
        assert f"<td>{cell}</td>" in found
    assert "<b>right arm</b> not shown" in found and "<td>right arm</td>" not in found


def test_the_report_begins_with_it():
    r = replace(walk(), verdict=Verdict.of([LEG]))
    page = report_page(r, summarise(r))
    assert page.index('id="verdict"') < page.index('<section id="quality"')
    assert 'class="verdict good"' in report_page(walk(), summarise(walk())), "an older file is judged"
