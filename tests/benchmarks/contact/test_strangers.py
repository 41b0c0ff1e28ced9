"""The moment at L5/S1 is that of what is above it, whatever holds it."""

import numpy as np

from benchmarks.contact.strangers import LUMBOSACRAL_M, lumbosacral_moment
from mbkf.conventions import GRAVITY_M_S2
from mbkf.model.human import HumanModel
from mbkf.synthesis.person import body_of, synthesise_subject
from tests.motions import assert_near


class Still:
    """A person who stands still in a posture, with something in the hands."""

    def __init__(self, q, subject, names, wrench):
        nv = HumanModel.of(subject).nv
        self.q, self.v, self.a = q[None], np.zeros((1, nv)), np.zeros((1, nv))
        self.subject, self.support_names, self.support_wrench = subject, names, wrench[None]


def test_a_load_in_the_hand_adds_its_own_moment():
    subject = synthesise_subject(0)
    model = body_of(subject)
    q = model.neutral()
    none, load = np.zeros((1, 6)), np.array([[0.0, 0.0, -150.0, 0.0, 0.0, 0.0]])
    point = np.array([0.4, 0.0, 1.0])
    load[0, 3:] = np.cross(point, load[0, :3])
    empty = lumbosacral_moment(Still(q, subject, ("right_hand",), none))
    held = lumbosacral_moment(Still(q, subject, ("right_hand",), load))
    reach = point[0] - (q[0] + LUMBOSACRAL_M[0] * model.axis_scale(model.description.segment("pelvis"))[0])
    assert_near(held - empty, 150.0 * reach, 1e-9)
    assert abs(empty[0]) < 0.2 * subject.mass_kg * GRAVITY_M_S2
