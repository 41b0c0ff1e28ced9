"""Files of ground reactions that are named beside several captures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mbkf.errors import InvalidInput


def forces_of(trials: Sequence[str], forces: Sequence[str]) -> list[str | None]:
    """The force file of each trial, None for captures that bring their own plates.

    Args:
        trials: Files of the trials.
        forces: Files of ground reactions, in the order of the trials that need one.

    Raises:
        InvalidInput: There are not as many files as trials that need one.
    """
    from mbkf.io.capture import CAPTURES

    bare = [i for i, trial in enumerate(trials) if not CAPTURES.format_of(Path(trial)).brings_plates]
    if forces and len(forces) != len(bare):
        raise InvalidInput(
            f"--forces names {len(forces)} file{'s' if len(forces) > 1 else ''}, and {len(bare)} of the trials bring "
            "no plates; give one for each of these, in their order"
        )
    return [forces[bare.index(i)] if forces and i in bare else None for i in range(len(trials))]


def forces_of_person(
    static: str | None, trials: Sequence[str], forces: Sequence[str]
) -> tuple[str | None, list[str | None]]:
    """The force files of a static trial and of moving ones; with one file too few, the static trial has none.

    Args:
        static: The static trial's file, or None.
        trials: Files of the moving trials.
        forces: Files of ground reactions, in the order of the captures.

    Raises:
        InvalidInput: There are not as many files as captures that need one.
    """
    if static is None:
        return None, forces_of(trials, forces)
    try:
        first, *others = forces_of([static, *trials], forces)
    except InvalidInput:
        if not trials:
            raise
        return None, forces_of(trials, forces)
    return first, others
