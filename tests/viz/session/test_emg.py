"""The report's part on electromyograms: charts, bars of activity, stated filters and reference."""

from mbkf.study.session.gather import session_of
from mbkf.viz.session.document import session_page
from mbkf.viz.session.emg import emg_part
from mbkf.viz.session.terms import Terms
from tests.study.session.emg import mixed
from tests.study.session.sessions import session


def part(reference="peak", language="en"):
    made = session_of(mixed(), "x")
    return emg_part(made, made.gaits[0], Terms(language), reference)


def test_a_chart_for_each_muscle_with_bars_where_it_is_active():
    html = part()
    assert html.count('<svg class="chart"') == 2 and ">Soleus<" in html and ">EMG 3<" in html
    assert 'class="span r"' in html and 'class="span l"' not in html


def test_filters_and_reference_are_stated():
    html = part()
    for word in ("3 channels", "20–450 Hz", "6 Hz", "order 4 and 2", "largest envelope in this session"):
        assert word in html
    assert "mean of the envelope" in part("mean") and "in the trial walk 0" in part("walk 0")
    assert "filtro paso banda de 20–450 Hz" in part(language="es") and ">Sóleo<" in part(language="es")


def test_the_page_holds_it_where_there_are_electromyograms():
    made = session_of(mixed(), "x")
    assert "walk 0</p>" not in session_page(made) and ">EMG</h3>" in session_page(made)
    assert "in the trial walk 0" in session_page(made, emg_reference="walk 0")
    assert ">EMG</h3>" not in session_page(session())
