"""Charts of a session: cycles, means, norms, and the axis that measured cycles set."""

import re
from dataclasses import replace

import numpy as np

from mbkf.io.norms import Band
from mbkf.model.human import reference_body
from mbkf.study.session.comparison import by_curve, compare
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from mbkf.study.session.norms import norms_of
from mbkf.viz.session.charts import Shown, joint_rows, pair_charts, session_chart
from mbkf.viz.session.terms import Terms
from tests.study.session.sessions import estimated, person, session, walks

KNEE = Shown(Key("torque", "knee_angle"), "Knee <flexion>", "bent")
ENGLISH = Terms("en")


def ticks(svg):
    return [float(text.replace("−", "-")) for text in re.findall(r'class="y"[^>]*>([^<]*)<', svg)]


def test_cycles_are_thin_and_means_bold():
    svg = session_chart(session().gaits[0].sides, KNEE, None, ENGLISH)
    cycles = sum(len(side.cycles) for side in session().gaits[0].sides)
    assert svg.count('class="thin') == cycles and svg.count('class="line') == 2
    assert svg.count('class="band') == 2 and svg.count('class="mark') == 2
    assert "Knee &lt;flexion&gt;" in svg and "<flexion>" not in svg


def test_estimated_cycles_do_not_scale_the_axis():
    """One estimated cycle ten times as large leaves the axis as it is; it is drawn with dashes."""
    one, other = walks()
    wild = replace(estimated(other), moments=10.0 * other.moments)
    svg = session_chart(session_of([one, wild], "x").gaits[0].sides, KNEE, None, ENGLISH)
    alone = session_chart(session_of([one], "x").gaits[0].sides, KNEE, None, ENGLISH)
    assert ticks(svg) == ticks(alone) and 'class="thin r dashed"' in svg
    for side in "rl":
        means = [re.search(rf'class="line {side}" d="([^"]*)"', text)[1] for text in (svg, alone)]
        assert means[0] == means[1]


def test_only_estimated_cycles_are_dashed():
    svg = session_chart(session_of([estimated(r) for r in walks()], "x").gaits[0].sides, KNEE, None, ENGLISH)
    assert 'class="line r dashed"' in svg


def test_norms_stand_behind_where_units_agree():
    norms = norms_of([person(), person(1, 6)], "ours")
    band = norms.curves["walk", KNEE.key.quantity, KNEE.key.name]
    assert ("run", KNEE.key.quantity, KNEE.key.name) not in norms.curves
    assert 'class="band n"' in session_chart(session().gaits[0].sides, KNEE, band, ENGLISH)
    other = Band("N m", 2, band.mean, band.sd)
    assert 'class="band n"' not in session_chart(session().gaits[0].sides, KNEE, other, ENGLISH)


def test_what_nobody_knows_is_no_chart():
    unknown = Shown(Key("torque", "none"), "x", "")
    assert session_chart(session().gaits[0].sides, unknown, None, ENGLISH) == ""
    assert pair_charts({}, KNEE, ENGLISH) == []


def test_pairs_and_their_change():
    pairs = by_curve(compare(session(), session())[0])
    right, left, change = pair_charts(pairs, KNEE, ENGLISH)
    assert 'class="line b"' in right and 'class="line r"' in right and 'class="line l"' in left
    assert 'class="level"' in change and change.count('class="line') == 2
    one_sided = {key: pair for key, pair in pairs.items() if key[1] == 0}
    assert pair_charts(one_sided, KNEE, ENGLISH)[1] == ""


def test_rows_are_the_joints_coordinates_in_the_language():
    body = reference_body(session().subject)
    ((flexion, adduction, rotation),) = joint_rows(body, ["hip"], "angle", Terms("es"))
    assert flexion == Shown(Key("angle", "hip_flexion"), "Flexión de cadera", "muslo hacia delante")
    assert (adduction.key.name, rotation.key.name) == ("hip_adduction", "hip_rotation")
    assert joint_rows(body, ["none"], "angle", ENGLISH) == []
    assert np.isfinite(session().gaits[0].sides[0].curves[flexion.key].values).all()
