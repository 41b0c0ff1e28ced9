"""Records of foot contact: when feet bear and no plate reads any of them."""

import pytest

from mbkf.sensors.contact.records import Contact, unread


@pytest.mark.parametrize(
    ("contacts", "expected"),
    [
        ((Contact.UNMEASURED, Contact.UNMEASURED), True),
        ((Contact.UNMEASURED, Contact.AIR), True),
        ((Contact.AIR, Contact.AIR), False),
        ((Contact.UNMEASURED, Contact.MEASURED), False),
        ((Contact.SHARED, Contact.SHARED), False),
        ((), False),
    ],
)
def test_feet_bear_and_no_plate_reads_them(contacts, expected):
    assert unread(contacts) is expected
