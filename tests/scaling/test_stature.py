"""A person of mass and height: the reference body as a whole, larger or smaller."""

import pytest

from mbkf.errors import InvalidInput
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.scaling.stature import person_of_stature, stature_doubts


def test_segments_grow_with_the_height():
    tall, short = (HumanModel.of(person_of_stature(70.0, height)) for height in (1.9, 1.52))
    for one, other in zip(tall.scale, short.scale, strict=True):
        assert one / other == pytest.approx(1.25)
    assert tall.mass_kg == pytest.approx(70.0)


@pytest.mark.parametrize(("mass", "height", "named"), [(0.0, 1.7, "--mass"), (70.0, 170.0, "--height")])
def test_no_person_is_so(mass, height, named):
    with pytest.raises(InvalidInput, match=named):
        person_of_stature(mass, height)


def test_a_height_that_the_segments_contradict_is_doubted():
    person, body = person_of_stature(70.0, 1.83), load_body("human18")
    assert stature_doubts(1.75, person, body) == () and stature_doubts(None, person, body) == ()
    (doubt,) = stature_doubts(1.58, person, body)
    assert "1.58 m" in doubt and "1.83 m" in doubt and "--height" in doubt
    assert len(stature_doubts(2.10, person, body)) == 1
