"""EMG of a trial's report: a chart for each muscle, both sides in it, bars while it is active, filters stated."""

from dataclasses import replace

from mbkf.viz.report.document import report_page
from mbkf.viz.report.emg import emg_section
from tests.study.session.emg import mixed
from tests.study.session.sessions import walks


def test_each_muscle_has_a_chart_with_its_bursts():
    r = next(one for one in mixed() if one.emg_envelope is not None)
    html = emg_section(r)
    muscles = {name.rpartition("_")[0] for name in r.muscle_names}
    assert html.count("<svg") == len(muscles) and "band-passed 20–450 Hz" in html
    assert html.count('class="span') == len(r.muscle_bursts) > 0
    assert emg_section(replace(r, muscle_bursts=())).count('class="span') == 0


def test_a_trial_without_emg_has_no_such_part():
    assert emg_section(walks()[0]) == ""


def test_the_page_names_muscles_in_its_language():
    r = next(one for one in mixed() if one.emg_envelope is not None)
    page = report_page(r, {}, language="es")
    assert 'id="emg"' in page and "filtro paso banda de 20–450 Hz" in page
