"""Words of a convention in one language: titles of its curves, and the statement that stands on every chart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mbkf.trial.gait.convention import CLINICAL, Convention
from mbkf.viz.language import filled, words


def angle_title(language: str, convention: Convention, name: str, otherwise: str) -> str:
    """Title of an angle.

    Args:
        language: Code of the language.
        convention: The convention.
        name: The coordinate, without its side.
        otherwise: The title, where the convention has no own one.
    """
    return _clinical("clinical_coordinates", language, convention).get(name, otherwise)


def angle_positive(language: str, convention: Convention, name: str, otherwise: str) -> str:
    """Meaning of a positive angle.

    Args:
        language: Code of the language.
        convention: The convention.
        name: The coordinate, without its side.
        otherwise: The meaning, where the convention has no own one.
    """
    return _clinical("clinical_positive", language, convention).get(name, otherwise)


def _clinical(section: str, language: str, convention: Convention) -> Mapping[str, str]:
    """A section of words of the clinical convention; empty in another one."""
    return words(language, section) if convention.name == CLINICAL else {}


def moment_title(language: str, convention: Convention, name: str, otherwise: str) -> str:
    """Title of the moment of a coordinate; it states the positive sense where the convention has an own one.

    Args:
        language: Code of the language.
        convention: The convention.
        name: The coordinate, without its side.
        otherwise: The title, where the convention has no own one.
    """
    own = words(language, f"{convention.moments}_moments") if name in convention.reversed_moments else {}
    return own.get(name, otherwise)


def statement(language: str, convention: Convention, axes: Sequence[str]) -> str:
    """The convention and the axes of angles in short, for charts.

    Args:
        language: Code of the language.
        convention: The convention.
        axes: Axes that the trials are read in.
    """
    say = words(language, "convention")
    read = say[f"axes_{axes[0]}" if len(axes) == 1 else "axes_several"]
    return filled(say["stated"], words(language, "chart_choices")[convention.name], read)


def notes(language: str, convention: Convention, axes: Sequence[str]) -> list[str]:
    """Sentences above charts: the convention, and the direction in which pelvis, trunk and feet are read.

    Args:
        language: Code of the language.
        convention: The convention.
        axes: Axes that the trials are read in.
    """
    say = words(language, "convention")
    read = say[f"axes_{axes[0]}" if len(axes) == 1 else "axes_several"]
    found = [filled(say["note"], words(language, "chart_choices")[convention.name], read)]
    return [*found, say["walking_note"]] if convention.walking else found


def moment_note(language: str, convention: Convention, otherwise: str) -> str:
    """The sentence on the sense of moments.

    Args:
        language: Code of the language.
        convention: The convention.
        otherwise: The sentence for the body's own.
    """
    say = words(language, "convention")
    return say[f"moment_{convention.moments}"] if convention.reversed_moments else otherwise
