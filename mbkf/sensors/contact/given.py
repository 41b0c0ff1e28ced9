"""Contact of the feet that is known beforehand, for studies of a filter at a chosen state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.records import Contact, ContactDecision, KeptContact, Planted


class GivenContact(ContactDetector):
    """A detector that answers with the same contacts and wrenches in every frame.

    Attributes:
        contacts: Contact of right and left foot.
        wrench: (2, 6) wrenches that plates read under them, N and N m about the world's origin.
    """

    def __init__(self, model: Body, contacts: tuple[Contact, Contact], wrench: Array, dt_s: float) -> None:
        """Makes the detector.

        Args:
            model: The body.
            contacts: Contact of right and left foot.
            wrench: (2, 6) wrenches, of which those of measured feet are used.
            dt_s: Time between frames.
        """
        super().__init__(model, (), dt_s)
        self.contacts = contacts
        measured = np.array([one == Contact.MEASURED for one in contacts])
        self.wrench = np.where(measured[:, None], wrench, 0.0)
        self._soles = FeetOnBody(model)

    def decide(
        self,
        memory: KeptContact,
        q: Array,
        v: Array,
        a: Array,
        plate_wrench: Array,
        supported: bool = False,
    ) -> ContactDecision:
        """The given contacts, with the middles of the soles at q (nq,) moving with v (nv,)."""
        del a, plate_wrench, supported
        return ContactDecision(self.contacts, self.wrench, self._soles.at(q, v).middles_m, False, memory)

    def planted(self, decision: ContactDecision, q: Array, foot: int) -> Planted | None:
        """Lowest point of a sole that bears; no plate has a place on which its centre of pressure would lie.

        Args:
            decision: The frame's decision.
            q: (nq,) configuration it was taken for.
            foot: 0 right, 1 left.
        """
        elsewhere = [one if one == Contact.AIR else Contact.UNMEASURED for one in decision.contacts]
        return super().planted(replace(decision, contacts=(elsewhere[0], elsewhere[1])), q, foot)
