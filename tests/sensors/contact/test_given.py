"""Contact that is known beforehand."""

import numpy as np

from mbkf.sensors.contact.given import GivenContact
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.soles import sole_points
from tests.dynamics import DT
from tests.motions import reference_model

MODEL = reference_model()
STILL = np.zeros(MODEL.nv)
WRENCH = np.arange(1.0, 13.0).reshape(2, 6)


def given(right, left):
    return GivenContact(MODEL, (right, left), WRENCH, DT)


def test_every_frame_has_the_given_contacts_and_the_wrenches_of_measured_feet():
    detector, q = given(Contact.MEASURED, Contact.UNMEASURED), MODEL.neutral()
    decision = detector.decide(detector.begin(), q, STILL, STILL, np.zeros((0, 6)))
    assert decision.contacts == (Contact.MEASURED, Contact.UNMEASURED)
    np.testing.assert_array_equal(decision.wrench, [WRENCH[0], np.zeros(6)])
    for middle, sole in zip(decision.centres_m, sole_points(MODEL, q[None])[0], strict=True):
        assert np.min(np.array(sole), axis=0)[0] < middle[0] < np.max(np.array(sole), axis=0)[0]


def test_a_foot_that_bears_is_planted_at_the_lowest_point_of_its_sole():
    detector, q = given(Contact.MEASURED, Contact.AIR), MODEL.neutral()
    decision = detector.decide(detector.begin(), q, STILL, STILL, np.zeros((0, 6)))
    planted = detector.planted(decision, q, 0)
    assert planted.segment == MODEL.roles.feet[0]
    assert planted.point_m[2] == min(point[2] for point in sole_points(MODEL, q[None])[0][0])
    assert detector.planted(decision, q, 1) is None
