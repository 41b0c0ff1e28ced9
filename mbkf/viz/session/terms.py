"""The words of a session's report in one language."""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.viz.language import filled, words


@dataclass(frozen=True)
class Terms:
    """A report's words.

    Attributes:
        language: Its code, e.g. "es".
    """

    language: str

    def say(self, name: str, *values: object) -> str:
        """A text of the section ``session_report``, filled with values."""
        return filled(words(self.language, "session_report")[name], *values)

    def measure(self, name: str) -> str:
        """The name of a measure, e.g. "Step length"."""
        return words(self.language, "measures").get(name, name)

    def unit(self, name: str) -> str:
        """The sign of a unit, e.g. "°" for "deg"."""
        return words(self.language, "units").get(name, name)

    def joint(self, name: str) -> str:
        """The name of a joint, e.g. "knee"; joints of other bodies keep their names."""
        return words(self.language, "joints").get(name, name.replace("_", " ").capitalize())

    def muscle(self, name: str) -> str:
        """The name of a muscle, e.g. "Soleus"; channels without a known muscle keep their names."""
        return words(self.language, "muscles").get(name, name.replace("_", " ").upper())

    def score(self, name: str) -> str:
        """The name of a score, e.g. "GPS"; that of a single variable is its coordinate's."""
        return words(self.language, "coordinates").get(name, name)

    def coordinate(self, name: str, otherwise: str) -> str:
        """The title of a coordinate without its side, or the body's own one."""
        return words(self.language, "coordinates").get(name, otherwise)

    def positive(self, name: str, otherwise: str) -> str:
        """The meaning of a positive value, or the body's own words."""
        return words(self.language, "positive").get(name, otherwise)
