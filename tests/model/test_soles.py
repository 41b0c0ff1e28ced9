"""Places of the soles on the body: under the feet, scaled with them, by names."""

import numpy as np

from mbkf.model.soles import sole_locals, sole_names
from tests.motions import assert_near, random_model, reference_model


def test_soles_lie_below_the_ankles_from_heel_to_toe():
    model = reference_model()
    segments, places = sole_locals(model)
    assert segments == ("right_foot",) * 3 + ("left_foot",) * 3
    assert (np.diff(places.reshape(2, 3, 3)[..., 0]) > 0).all()
    assert_near(places[3:], places[:3] * [1, -1, 1], 1e-15)


def test_soles_scale_with_the_foot():
    model = random_model(np.random.default_rng(3))
    _, places = sole_locals(model)
    foot = model.description.segment("right_foot")
    assert_near(places[0] / sole_locals(reference_model())[1][0], model.axis_scale(foot), 1e-12)


def test_names_of_sole_points():
    names = sole_names(reference_model())
    assert names == tuple(
        f"{side}_foot_{part}" for side in ("right", "left") for part in ("heel", "ball", "toe")
    )
