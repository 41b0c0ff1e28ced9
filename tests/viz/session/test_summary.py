"""The sheet: two pages with the parameters by hand, bold outside of the norm, and one page without gait."""

import re
from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.laboratory import Laboratory
from mbkf.io.norms import Band
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from mbkf.study.session.norms import norms_of
from mbkf.trial.gait.convention import BY_CLINIC
from mbkf.viz.session.summary import PARAMETERS, consistency, summary_part
from mbkf.viz.session.terms import Terms
from tests.recordings import recorded
from tests.study.session.sessions import person, session, walks


def sheet(one, norms=None, language="en"):
    return summary_part(one, norms, Laboratory(), Terms(language, one.convention, one.axes))


def test_numbers_of_the_table_are_those_of_the_cycles():
    page, (gait,) = sheet(session()), session().gaits
    assert page.count('class="leaf"') == 2 and "signature" in page
    lengths = gait.measure("Step length").values
    cells = "".join(f"<td>{lengths[s].mean():.3f} ± {lengths[s].std(ddof=1):.3f}</td>" for s in "rl")
    assert f"<td>Step length, m</td>{cells}</tr>" in page
    titles = re.findall(r"<tr><td>([^<]*), [^,<]*</td>", page)
    assert titles[: len(PARAMETERS) - 1] == [
        "Foot off" if name == "Stance" else name for name in PARAMETERS if name != "Flight"
    ]


def test_values_outside_of_the_norm_are_bold():
    norms, (gait,) = norms_of([person(), person(1, 6)], "ours"), session().gaits
    mean = float(gait.measure("Speed").values["r"].mean())
    for apart, bold in ((1.9, False), (2.1, True)):
        band = Band("m/s", 2, np.array([mean + apart * 0.05]), np.array([0.05]))
        found = sheet(session(), replace(norms, measures={**norms.measures, ("walk", "Speed"): band}))
        row = re.search(r"<tr><td>Speed, m/s</td><td>(<b>)?", found)
        assert (row[1] is not None) == bold
    assert "GPS" in sheet(session(), norms) and "GPS" not in sheet(session())


def test_consistency_is_the_root_mean_square_of_the_spread():
    (gait,) = session().gaits
    values = gait.sides[0].curves[Key("angle", "knee_angle")].values
    assert consistency(gait, Key("angle", "knee_angle"), 0) == pytest.approx(
        np.sqrt((values.std(axis=0, ddof=1) ** 2).mean())
    )
    assert np.isnan(consistency(gait, Key("angle", "no such"), 0))


def test_the_clinical_sheet_has_the_nine_charts_of_laboratories():
    one = session_of(walks(), "x", convention=BY_CLINIC)
    second = sheet(one).split('class="leaf"')[2]
    labels = re.findall(r'aria-label="([^"]*)"', second)
    assert len(labels) == 18 and labels[0] == "Anterior pelvic tilt" and "Foot progression" in labels[8]
    assert labels[9:] == [
        "Hip extensor moment", "Knee extensor moment", "Ankle plantarflexor moment", "Hip power", "Knee power",
        "Ankle power", "Hip abductor moment", "Knee abductor moment", "Vertical ground reaction",
    ]  # fmt: skip


def test_a_session_without_gait_has_one_page_with_its_measures():
    page = sheet(session_of([recorded("jump", 3.0, 2)], "x"), language="es")
    assert page.count('class="leaf"') == 1 and "Tiempo de vuelo" in page and "Firma" in page
