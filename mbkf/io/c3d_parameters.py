"""Parameters of a C3D file: names in any case, lists with continuations, odd dimensions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mbkf.conventions import Array

CONTINUATIONS = 1000
"""Bound of a list's continuations (LABELS2, LABELS3 …)."""


class C3dParameters:
    """Read access to a file's parameters; names are found in any case, missing ones are empty."""

    def __init__(self, groups: Mapping[str, Mapping[str, object]]) -> None:
        """Args: by group and name, texts (a list) or numbers (an array)."""
        self._groups = {
            group.upper(): {name.upper(): value for name, value in members.items()}
            for group, members in groups.items()
        }

    def group(self, group: str) -> dict[str, object]:
        """All parameters of a group, name in capitals → value."""
        return dict(self._groups.get(group.upper(), {}))

    def numbers(self, group: str, name: str) -> Array:
        """A parameter as an array of numbers; empty where it is missing or text."""
        value = self._groups.get(group.upper(), {}).get(name.upper(), ())
        try:
            return np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            return np.zeros(0)

    def number(self, group: str, name: str, default: float = 0.0) -> float:
        """First number of a parameter.

        Args:
            group: Name of the group.
            name: Name of the parameter.
            default: Value of a missing parameter.
        """
        values = self.numbers(group, name).ravel()
        return float(values[0]) if len(values) else default

    def all_numbers(self, group: str, name: str) -> Array:
        """(n,) numbers of a parameter and of its continuations (NAME2, NAME3 …)."""
        found = [self.numbers(group, name).ravel()]
        for number in range(2, CONTINUATIONS):
            if f"{name.upper()}{number}" not in self._groups.get(group.upper(), {}):
                break
            found.append(self.numbers(group, f"{name}{number}").ravel())
        return np.concatenate(found)

    def single_numbers(self, group: str) -> dict[str, float]:
        """The parameters of a group that are one finite number each, by their names in capitals."""
        found = {name: self.numbers(group, name).ravel() for name in self.group(group)}
        return {name: float(v[0]) for name, v in found.items() if len(v) == 1 and np.isfinite(v[0])}

    def texts(self, group: str, name: str) -> list[str]:
        """A parameter as texts without surrounding blanks, its continuations (NAME2, NAME3 …) appended; no numbers."""
        found: list[str] = []
        members = self._groups.get(group.upper(), {})
        for number in range(1, CONTINUATIONS):
            key = name.upper() + (str(number) if number > 1 else "")
            if key not in members:
                break
            value = members[key]
            words = [value] if isinstance(value, str) else np.ravel(np.asarray(value, dtype=object))
            found += [word.strip() for word in words if isinstance(word, str)]
        return found

    def text(self, group: str, name: str) -> str:
        """First text of a parameter, "" where it is missing."""
        return next(iter(self.texts(group, name)), "")

    def per_plate(self, name: str, shape: tuple[int, ...]) -> list[Array]:
        """One block per plate of an array parameter of FORCE_PLATFORM; fewer than plates where the parameter is short.

        Args:
            name: CORNERS, ORIGIN, CHANNEL or CAL_MATRIX.
            shape: Shape of one plate's block; −1 stands for the size in the file.
        """
        values = self.numbers("FORCE_PLATFORM", name)
        if not values.size:
            return []
        rows = tuple(values.shape[0] if size == -1 else size for size in shape)
        block = int(np.prod(rows))
        flat = values.ravel(order="F")
        count = len(flat) // block
        return [flat[i * block : (i + 1) * block].reshape(rows, order="F") for i in range(count)]
