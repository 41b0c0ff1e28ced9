"""Scores: Baker's and Schwartz's formulas by hand, the body's shift, and the interval of a mean."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.norms import Band, Norms
from mbkf.study.session.cycles import Key
from mbkf.study.session.means import half_width
from mbkf.study.session.scores import VARIABLES, gait_scores, gdi_basis
from tests.study.session.sessions import person

KNOWN = VARIABLES[:8]


def gait():
    return person().gaits[0]


def norms(shift=0.0, names=KNOWN):
    """Norms whose means are the first right cycle, moved by a constant."""
    right = gait().sides[0]
    curves = {
        ("walk", "angle", name): Band(
            "deg", 9, right.curves[Key("angle", name)].values[0] + shift, np.ones(101)
        )
        for name in names
    }
    return Norms("n", curves, {})


def values(side, name):
    return side.curves[Key("angle", name)].values


def test_variable_scores_are_root_mean_squares_over_cycles():
    known = norms(shift=3.0)
    scores = gait_scores(gait(), known)
    for side, found in zip(gait().sides, scores.sides, strict=True):
        each = {
            name: np.sqrt(((values(side, name) - known.curves["walk", "angle", name].mean) ** 2).mean(axis=1))
            for name in KNOWN
        }
        for name in KNOWN:
            assert found.gvs[name].mean[0] == pytest.approx(each[name].mean())
        gps = np.sqrt(np.mean([one**2 for one in each.values()], axis=0))
        assert found.gps.mean[0] == pytest.approx(gps.mean())
    assert scores.lacking == ("foot_progression",)


def test_the_overall_score_has_the_pelvis_once():
    """Of constant distances: 3 of the left pelvis, 2 × 5 of the legs."""
    moved = {name: 1.0 + k for k, name in enumerate(KNOWN)}
    right, left = gait().sides
    same = [
        replace(
            side,
            curves={
                Key("angle", name): replace(
                    side.curves[Key("angle", name)], values=np.zeros((len(side.cycles), 101))
                )
                for name in KNOWN
            },
        )
        for side in (right, left)
    ]
    curves = {
        ("walk", "angle", name): Band("deg", 9, np.full(101, value), np.ones(101))
        for name, value in moved.items()
    }
    scores = gait_scores(replace(gait(), sides=tuple(same)), Norms("n", curves, {}))
    squares = [moved[name] ** 2 for name in KNOWN]
    assert scores.sides[0].gps.mean[0] == pytest.approx(np.sqrt(np.mean(squares)))
    assert scores.gps.mean[0] == pytest.approx(np.sqrt((sum(squares) + sum(squares[3:])) / 13.0))


def test_a_shift_of_the_body_is_in_the_interval_by_its_gradient():
    """A curve that lies 4° off throughout, and whose body shifts it by 2°, has a score of 4° ± 1.96 × 2°."""
    side = gait().sides[0]
    knee = side.curves[Key("angle", "knee_angle")]
    ones = np.ones_like(knee.values)
    flat = replace(knee, values=4.0 * ones, sd=2.0 * ones, shift_sd=2.0 * ones)
    alone = replace(side, curves={Key("angle", "knee_angle"): flat})
    known = Norms("n", {("walk", "angle", "knee_angle"): Band("deg", 9, np.zeros(101), np.ones(101))}, {})
    scores = gait_scores(replace(gait(), sides=(alone, replace(alone, side=1))), known)
    found = scores.sides[0].gvs["knee_angle"]
    assert found.mean[0] == pytest.approx(4.0) and half_width(found)[0] == pytest.approx(1.96 * 2.0, rel=1e-3)


@pytest.mark.parametrize(
    ("off", "expected"), [(0.0, 1.96 * 2.0), (1.0, np.sqrt(1.0 + (1.96 * 2.0) ** 2) - 1.0)]
)
def test_a_shift_square_to_the_curve_is_in_the_interval(off, expected):
    """A sine about the norm, or the norm itself, and a body that shifts it by 2° throughout: the gradient is zero."""
    side = gait().sides[0]
    knee = side.curves[Key("angle", "knee_angle")]
    ones = np.ones_like(knee.values)
    sine = off * np.sqrt(2.0) * np.sin(2.0 * np.pi * (np.arange(101) + 0.5) / 101.0) * ones
    curves = {Key("angle", "knee_angle"): replace(knee, values=sine, sd=2.0 * ones, shift_sd=2.0 * ones)}
    known = Norms("n", {("walk", "angle", "knee_angle"): Band("deg", 9, np.zeros(101), np.ones(101))}, {})
    alone = replace(side, curves=curves)
    scores = gait_scores(replace(gait(), sides=(alone, replace(alone, side=1))), known)
    found = scores.sides[0].gvs["knee_angle"]
    assert found.mean[0] == pytest.approx(off) and half_width(found)[0] == pytest.approx(expected, rel=1e-4)


def test_the_index_is_schwartz_s_formula_and_100_on_average_of_the_controls():
    rng = np.random.default_rng(1)
    controls = rng.standard_normal((40, 8 * 51)).cumsum(axis=1)
    basis = gdi_basis(controls, KNOWN, 15)
    along = controls @ basis.features.T - basis.centre
    logs = np.log(np.linalg.norm(along, axis=1))
    assert (basis.ln_mean, basis.ln_sd) == pytest.approx((logs.mean(), logs.std(ddof=1)))
    np.testing.assert_allclose(basis.features @ basis.features.T, np.eye(15), atol=1e-12)
    scores = gait_scores(gait(), replace(norms(1.0), gdi=basis))
    for side, found in zip(gait().sides, scores.sides, strict=True):
        vectors = np.concatenate([values(side, name)[:, ::2] for name in KNOWN], axis=1)
        distance = np.linalg.norm(vectors @ basis.features.T - basis.centre, axis=1)
        expected = 100.0 - 10.0 * (np.log(distance) - basis.ln_mean) / basis.ln_sd
        assert found.gdi.mean[0] == pytest.approx(expected.mean())
    other = replace(basis, variables=(*KNOWN[1:], KNOWN[0]))
    assert gait_scores(gait(), replace(norms(1.0), gdi=other)).sides[0].gdi is None


def test_the_gradient_of_the_index_is_its_derivative():
    """The body's shift over all angles alike moves the index as a finite difference does."""
    rng = np.random.default_rng(2)
    basis = gdi_basis(rng.standard_normal((40, 51)).cumsum(axis=1), ("knee_angle",), 15)
    side = gait().sides[0]
    knee = side.curves[Key("angle", "knee_angle")]
    known = Norms(
        "n", {("walk", "angle", "knee_angle"): Band("deg", 9, np.zeros(101), np.ones(101))}, {}, gdi=basis
    )

    def index(moved, shift):
        one = replace(
            knee,
            values=knee.values + moved,
            sd=np.full_like(knee.sd, shift),
            shift_sd=np.full_like(knee.sd, shift),
        )
        alone = replace(side, curves={Key("angle", "knee_angle"): one})
        return (
            gait_scores(replace(gait(), sides=(alone, replace(alone, cycles=(), curves={}))), known)
            .sides[0]
            .gdi
        )

    slope = (index(1e-4, 0.0).mean[0] - index(-1e-4, 0.0).mean[0]) / 2e-4
    assert np.sqrt(index(0.0, 1.0).shift_variance[0]) == pytest.approx(abs(slope), rel=1e-4)


def test_norms_without_angles_or_in_another_unit_give_no_scores():
    assert gait_scores(gait(), Norms("n", {}, {})) is None
    radian = {key: replace(band, unit="rad") for key, band in norms().curves.items()}
    assert gait_scores(gait(), Norms("n", radian, {})) is None
