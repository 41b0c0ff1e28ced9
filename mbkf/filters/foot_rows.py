"""What the dynamic filter reads of the feet's wrenches, as whitened rows, and how they wander between frames."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.sensors.contact.records import Contact, ContactDecision


class FootRows:
    """Twelve rows on the wrenches of right and left foot.

    Moments are weighed about the middle of the sole, where they are small.
    """

    def __init__(self, first: int, weight_n: float, dt_s: float, settings: DynamicSettings) -> None:
        """Args: where the wrenches begin in the state, the body's weight, the time step, and what is believed."""
        self._first, self._weight_n = first, weight_n
        s = settings
        self._plate = 1.0 / np.repeat([s.plate_force_n, s.plate_moment_nm], 3)
        self._air = 1.0 / np.repeat([s.air_force_n, s.air_moment_nm], 3)
        self._free = 1.0 / np.repeat([s.free_force_share * weight_n, s.free_lever_m * weight_n], 3)
        self._pulling = self._free.copy()
        self._pulling[2] = 1.0 / s.pulling_force_n
        self._walk = np.repeat([s.wrench_force, s.wrench_moment], 3) * dt_s**0.5

    def wander(self, load: ContactDecision) -> Array:
        """(2, 6, 6) covariance by which the feet's wrenches about the world's origin wander in a step."""
        shift = _about(-load.centres_m) * self._walk
        wander: Array = shift @ shift.transpose(0, 2, 1)
        return wander

    def fill(
        self, rows: Array, values: Array, w: Array, load: ContactDecision, lifted: tuple[int, ...]
    ) -> int:
        """Fills the rows (12, N) and innovations (12,); returns how many, the first ones, are plates' readings.

        Args:
            rows: To fill; zero.
            values: To fill.
            w: (12,) wrenches of right and left foot.
            load: What the feet stand on.
            lifted: Free feet, 0 right and 1 left, that carry nothing.
        """
        if Contact.SHARED in load.contacts:
            return self._shared(rows, values, w, load)
        first, plates = self._first, 0
        about = _about(load.centres_m)
        only_left = load.contacts[0] != Contact.MEASURED and load.contacts[1] == Contact.MEASURED
        for place, foot in enumerate((1, 0) if only_left else (0, 1)):
            wrench, mine = w[6 * foot : 6 * foot + 6], slice(6 * place, 6 * place + 6)
            pulls = wrench[2] < 0.0 or foot in lifted
            X = about[foot] * self._weight(load.contacts[foot], pulls)[:, None]
            rows[mine, first + 6 * foot : first + 6 * foot + 6] = X
            values[mine] = X @ (self._expected(load, foot, pulls) - wrench)
            plates += 6 * (load.contacts[foot] == Contact.MEASURED)
        return plates

    def _expected(self, load: ContactDecision, foot: int, pulls: bool) -> Array:
        """(6,) wrench a foot is read to carry: its plate's, nothing, or its share of what no plate carries.

        A free foot that would pull at the floor is held at nothing instead.
        """
        if load.contacts[foot] != Contact.UNMEASURED or pulls:
            return load.wrench[foot]
        other = load.contacts[1 - foot]
        carried = float(load.wrench[1 - foot, 2]) if other == Contact.MEASURED else 0.0
        rest = max(self._weight_n - carried, 0.0) * (0.5 if other == Contact.UNMEASURED else 1.0)
        x, y, _ = load.centres_m[foot].tolist()
        return np.array([0.0, 0.0, rest, y * rest, -x * rest, 0.0])

    def _weight(self, footing: Contact, pulls: bool) -> Array:
        """(6,) 1/sd of a foot's rows; a free foot that would pull at the floor is held at no vertical force."""
        if footing == Contact.MEASURED:
            return self._plate
        if footing == Contact.AIR:
            return self._air
        return self._pulling if pulls else self._free

    def _shared(self, rows: Array, values: Array, w: Array, load: ContactDecision) -> int:
        """One plate reads the sum of both wrenches; each is weakly held near a half of it."""
        first = self._first
        middle = _about(load.centres_m.mean(axis=0, keepdims=True))[0] * self._plate[:, None]
        rows[:6, first : first + 6] = rows[:6, first + 6 :] = middle
        values[:6] = middle @ (load.wrench[0] - w[:6] - w[6:])
        half = _about(load.centres_m[:1])[0] * self._free[:, None]
        rows[6:, first : first + 6] = half
        values[6:] = half @ (0.5 * load.wrench[0] - w[:6])
        return 6


def _about(points_m: Array) -> Array:
    """(k, 6, 6) that take a wrench about the world's origin to one about each of the points (k, 3): n − c × f."""
    found = points_m @ _LEVERS
    found += _UNMOVED
    return found.reshape(-1, 6, 6)


def _levers() -> Array:
    """(3, 36) by which a unit shift along each axis changes :func:`_about`."""
    table = np.zeros((3, 6, 6))
    for x, y, z in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        table[x, 3 + z, y], table[x, 3 + y, z] = -1.0, 1.0
    return table.reshape(3, 36)


_LEVERS = _levers()
_UNMOVED = np.eye(6).ravel()
