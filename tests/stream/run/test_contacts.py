"""Contacts of a live run: one entry for each part from when it opens to when it closes, and an event."""

import numpy as np

from mbkf.stream.run.contacts import MOST, ContactList


def support(**forces):
    """(2, 6) wrenches on pelvis and right hand with upward forces, N."""
    found = np.zeros((2, 6))
    for k, name in enumerate(("pelvis", "right_hand")):
        found[k, 2] = forces.get(name, 0.0)
    return found


def test_a_contact_is_listed_from_when_it_opens_to_its_last_frame_with_its_largest_force():
    notes = []
    contacts = ContactList(("pelvis", "right_hand"), lambda *note: notes.append(note))
    assert not contacts.push(np.full((2, 6), np.nan), 0.0, 0)
    changes = [
        contacts.push(support(pelvis=100.0), 0.1, 1),
        contacts.push(support(pelvis=300.0), 0.2, 2),
        contacts.push(support(pelvis=200.0, right_hand=50.0), 0.3, 3),
        contacts.push(support(), 0.4, 4),
        contacts.push(support(pelvis=10.0), 0.5, 5),
    ]
    assert changes == [True, False, False, True, True]
    assert contacts.plain() == [
        {"part": "pelvis", "from_s": 0.1, "to_s": 0.3, "peak_n": 300.0},
        {"part": "right_hand", "from_s": 0.3, "to_s": 0.3, "peak_n": 50.0},
        {"part": "pelvis", "from_s": 0.5, "to_s": 0.5, "peak_n": 10.0},
    ]
    assert [(kind, number) for kind, _, number, _ in notes] == [
        ("contact", 1),
        ("contact", 3),
        ("contact", 5),
    ]
    assert contacts.sentences() == (
        "the pelvis bore up to 300 N from 0.10 to 0.30 s",
        "the right hand bore up to 50 N from 0.30 to 0.30 s",
        "the pelvis bears load since 0.50 s",
    )
    assert notes[1][1] == "the right hand bears load: a contact opened"


def test_a_run_lists_no_more_than_it_has_room_for():
    contacts = ContactList(("pelvis", "right_hand"), lambda *note: None)
    for t in range(2 * MOST + 10):
        contacts.push(support(pelvis=100.0 * (t % 2)), 0.1 * t, t)
    assert len(contacts.plain()) == MOST
