"""The words of a session's report in one language."""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.trial.gait.convention import BY_MODEL, MODEL, Convention
from mbkf.viz.convention_words import angle_positive, angle_title, moment_note, moment_title, notes, statement
from mbkf.viz.language import filled, words


@dataclass(frozen=True)
class Terms:
    """A report's words.

    Attributes:
        language: Its code, e.g. "es".
        convention: Axes and signs of the curves.
        axes: Axes that the trials' angles are read in.
    """

    language: str
    convention: Convention = BY_MODEL
    axes: tuple[str, ...] = (MODEL,)

    @property
    def statement(self) -> str:
        """The convention in short, for charts."""
        return statement(self.language, self.convention, self.axes)

    @property
    def moment_statement(self) -> str:
        """The convention of moments in short; they are about the body's own axes."""
        return statement(self.language, self.convention, (MODEL,))

    @property
    def convention_notes(self) -> list[str]:
        """The convention in sentences."""
        return notes(self.language, self.convention, self.axes)

    @property
    def moment_note(self) -> str:
        """The sense of moments."""
        return moment_note(self.language, self.convention, self.say("torque_note"))

    def moment(self, name: str, otherwise: str) -> str:
        """The title of the moment of a coordinate.

        Args:
            name: The coordinate, without its side.
            otherwise: The body's own title.
        """
        return moment_title(self.language, self.convention, name, self.coordinate(name, otherwise))

    def say(self, name: str, *values: object) -> str:
        """A text of the section ``session_report``, filled with values."""
        return filled(words(self.language, "session_report")[name], *values)

    def sheet(self, name: str, *values: object) -> str:
        """A text of the section ``sheet``, filled with values."""
        return filled(words(self.language, "sheet")[name], *values)

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
        known = words(self.language, "coordinates").get(name, otherwise)
        return angle_title(self.language, self.convention, name, known)

    def positive(self, name: str, otherwise: str) -> str:
        """The meaning of a positive value, or the body's own words."""
        known = words(self.language, "positive").get(name, otherwise)
        return angle_positive(self.language, self.convention, name, known)
