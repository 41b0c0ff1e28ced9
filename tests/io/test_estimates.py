"""Quantities of filters: codes are those of the contact decision, and a result holds what a track shares with it."""

from mbkf.filters.record import FIELDS, Track
from mbkf.io.estimates import CONTACT_CODES, Estimates, TrackEstimates
from mbkf.io.quantities import quantities
from mbkf.io.results import QUANTITIES
from mbkf.sensors.contact.records import Contact


def test_codes_of_contact_are_those_of_the_decision():
    words = {Contact.MEASURED: "own_plate", Contact.SHARED: "shared_plate"}
    assert {one.value: words.get(one, one.name.lower()) for one in Contact} == CONTACT_CODES


def test_a_track_and_a_result_share_the_declarations():
    shared = quantities(Estimates)
    assert len(shared) > 15
    for kind in (quantities(Track), quantities(TrackEstimates), QUANTITIES):
        assert {name: kind[name] for name in shared} == dict(shared)


def test_the_frame_record_holds_every_quantity_of_a_track():
    fields = {field.name: field.axes for field in FIELDS}
    for one in quantities(Track).values():
        assert one.axes[0] == "time"
        if one.written:
            assert fields[one.key] == one.axes[1:]
