"""The report's part on scores: values with intervals, the norms' own, the profile, and variables that lack."""

from dataclasses import replace

from mbkf.io.norms import Norms
from mbkf.study.session.means import half_width
from mbkf.study.session.norm_selection import of_trials
from mbkf.study.session.norms import norms_of
from mbkf.study.session.scores import gait_scores
from mbkf.viz.session.scores import scores_part
from mbkf.viz.session.terms import Terms
from tests.study.session.sessions import person


def ours():
    return norms_of([person(), person(1, 6)], "ours")


def test_scores_stand_with_their_intervals_beside_the_norms_own():
    (gait,) = person().gaits
    html, scores = scores_part(gait, ours(), Terms("en")), gait_scores(gait, ours())
    gps = scores.gps
    assert f"{gps.mean[0]:.1f} ± {half_width(gps)[0]:.1f}" in html
    own = ours().measures["walk", "GPS"]
    assert f"{own.mean[0]:.1f} ± {own.sd[0]:.1f}" in html
    assert "Knee flexion, °" in html and "lack them: Foot progression" in html and "GDI" not in html
    assert html.count('class="span r"') == html.count('class="span l"') == html.count('class="norm"') == 9


def test_too_few_cycles_have_no_interval():
    """Two cycles of a side leave one degree of freedom: an interval from ± 0 to ± 12° by chance."""
    (gait,) = person().gaits
    few = of_trials(gait, gait.trials)
    sides = tuple(
        replace(
            side,
            cycles=side.cycles[:2],
            curves={
                key: replace(c, **{n: getattr(c, n)[:2] for n in ("values", "sd", "shift_sd", "change_sd")})
                for key, c in side.curves.items()
            },
        )
        for side in few.sides
    )
    few = replace(few, sides=sides)
    html, scores = scores_part(few, ours(), Terms("en")), gait_scores(few, ours())
    right = scores.sides[0].gps
    assert right.count == 2 and f"<td>{right.mean[0]:.1f}</td>" in html
    assert "Intervals need 3 cycles" in html and "Intervals need" not in scores_part(
        gait, ours(), Terms("en")
    )


def test_no_norms_no_scores():
    (gait,) = person().gaits
    assert scores_part(gait, None, Terms("en")) == scores_part(gait, Norms("n", {}, {}), Terms("en")) == ""
