"""A stream as a run knows it, and the frames of the same stream described anew: markers by name, plates by place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.stream.identity import elsewhere, plate_places, same_rate
from mbkf.stream.source import PlateSamples, StreamDescription

_NOWHERE = (np.nan, np.nan, np.nan)


class KnownStream:
    """Maps what a stream sends to what the run knows of it.

    Attributes:
        stream: The description that the run began with.
        refused: The latest description is another stream's, so that its frames are left out.
    """

    def __init__(self, stream: StreamDescription) -> None:
        """Args: the description that the run begins with."""
        self.stream = stream
        self.refused = False
        self._place = {name: k for k, name in enumerate(stream.marker_names)}
        self._columns: list[int] | None = None
        self._plates: list[int | None] = list(range(len(stream.plates)))
        self._as_known = True

    def describe(self, found: StreamDescription) -> list[tuple[str, str]]:
        """Takes a later description; returns events. One of another rate, or without any known marker, is refused."""
        news: list[tuple[str, str]] = []
        try:
            same_rate(self.stream.rate_hz, found.rate_hz)
            self._columns = self._found_markers(found.marker_names, news)
        except InvalidInput as error:
            self.refused = True
            return [("refused", f"the stream is described as another one and left out: {error}")]
        self.refused = False
        self._find_plates(found, news)
        return news

    def by_name(self, found: Mapping[str, object]) -> Array:
        """(M, 3) known markers from coordinates by name; NaN for those that are absent, further names are left out.

        Raises:
            ValueError, TypeError, OverflowError: Coordinates are not three numbers.
        """
        if [*found] == [*self._place]:
            rows = [_NOWHERE if one is None else one for one in found.values()]
            return np.array(rows, dtype=float).reshape(len(rows), 3)
        markers = np.full((len(self._place), 3), np.nan)
        for name, one in found.items():
            if name in self._place and one is not None:
                markers[self._place[name]] = np.asarray(one, dtype=float).reshape(3)
        return markers

    def in_order(self, found: Array) -> Array:
        """(M, …) values of the known markers from those (F, …) of the latest description, NaN for absent ones."""
        if self._columns is None:
            return found
        return np.concatenate([found, np.full((1, *found.shape[1:]), np.nan)])[self._columns]

    def plate_samples(self, samples: PlateSamples) -> PlateSamples:
        """Samples of the known plates from those of the latest description; NaN for a plate that is gone."""
        if self._as_known:
            return samples
        wrench = np.full((len(samples.index), len(self._plates), 6), np.nan)
        for k, place in enumerate(self._plates):
            if place is not None:
                wrench[:, k] = samples.wrench[:, place]
        return PlateSamples(samples.index, wrench)

    def _found_markers(self, found: Sequence[str], news: list[tuple[str, str]]) -> list[int] | None:
        """Place of every known marker among those found, −1 for one that is missing; None where they are as known."""
        known = self.stream.marker_names
        if tuple(found) == known:
            return None
        if not known:
            raise InvalidInput("it has names where the points had none")
        places = [found.index(name) if name in found else -1 for name in known]
        missing = [name for name, place in zip(known, places, strict=True) if place < 0]
        if len(missing) == len(known):
            raise InvalidInput("it has none of the known markers")
        if missing:
            news.append(("markers", f"{len(missing)} of {len(known)} markers are gone ({missing[0]} …)"))
        return places

    def _find_plates(self, found: StreamDescription, news: list[tuple[str, str]]) -> None:
        known = self.stream.plates
        self._plates = plate_places(known, found.plates)
        for plate, place in zip(known, self._plates, strict=True):
            if place is None:
                why = elsewhere(plate, found.plates)
                news.append(("plates refused", f"{why}; it is not read any more"))
        if known and found.plates:
            try:
                same_rate(self.stream.plate_rate_hz, found.plate_rate_hz)
            except InvalidInput as error:
                self._plates = [None] * len(known)
                news.append(("plates refused", f"the plates are not read any more: {error}"))
        self._as_known = self._plates == list(range(len(found.plates)))
