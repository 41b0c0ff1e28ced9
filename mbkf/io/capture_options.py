"""Options of reading a capture, or a file of ground reactions: the record that every reader takes."""

from __future__ import annotations

from dataclasses import dataclass, field

from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N, PlateWay


@dataclass(frozen=True, kw_only=True)
class CaptureOptions:
    """Options of a reader.

    Attributes:
        up: Axis of the file that points up; None for the one that the file states, or the format's default.
        unit: Length unit; None for the one that the file states.
        cop_threshold_n: Vertical force in N below which no centre of pressure is given.
        tare: Remove the offset of unloaded plates.
        plates: Read the file's own force plates.
        unneeded_plates: Names of plates that will be withheld, and need not be readable.
        trial_end_s: Time that ground reactions have to reach to last as long as the trial, None where not known.
        shared_up: Axis with which markers were read that share their axes with the ground reactions; None otherwise.
        notes: Receives the remarks of a reader of ground reactions.
        left_out: Receives the plates that cannot be read, with the reason.
        ways: Ways to read the plates of a C3D file, by their names; receives those that it lacks, so that all parts of
            a file are read alike. None: the readings show them.
    """

    up: str | None = None
    unit: str | None = None
    cop_threshold_n: float = DEFAULT_COP_THRESHOLD_N
    tare: bool = True
    plates: bool = True
    unneeded_plates: tuple[str, ...] = ()
    trial_end_s: float | None = None
    shared_up: str | None = None
    notes: list[str] = field(default_factory=list, compare=False)
    left_out: dict[str, str] = field(default_factory=dict, compare=False)
    ways: dict[str, PlateWay] | None = field(default=None, compare=False)
