"""The C3D file of a recorded run, made from the log in its folder."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from mbkf.errors import MbkfError
from mbkf.io.c3d_write import write_c3d
from mbkf.io.written import check_absent
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.recording import read_recording


class WrittenRecording(NamedTuple):
    """Outcome of a recording.

    Attributes:
        file: The C3D file; None without a recording.
        frames: Number of its frames.
        problem: The reason why it could not be written; None where it was, and without a recording.
        left_out: Sentences on what is left out or filled in.
    """

    file: Path | None = None
    frames: int = 0
    problem: str | None = None
    left_out: tuple[str, ...] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        """Remarks for the run's report."""
        if self.problem is None:
            return self.left_out
        return (f"the recording could not be written: {self.problem}",)

    def plain(self) -> dict[str, object]:
        """Entries of live.json; empty without a recording."""
        if self.file is None and self.problem is None:
            return {}
        file = None if self.file is None else str(self.file)
        return {"recording": file, "frames_recorded": self.frames, "recording_problem": self.problem}


def write_recording(folder: Path) -> WrittenRecording:
    """Makes the C3D file of the recording in an output folder, if its run was recorded."""
    file = None
    try:
        found = read_recording(folder / LOG_FOLDER)
        if found is None:
            return WrittenRecording()
        file = found.to
        check_absent(file)
        write_c3d(found.capture, file, residuals_m=found.residuals_m)
    except (MbkfError, OSError) as error:
        return WrittenRecording(file, 0, str(error))
    except Exception as error:  # the log must outlive whatever a damaged or strange one brings about
        return WrittenRecording(file, 0, f"an unforeseen {type(error).__name__}: {error}")
    return WrittenRecording(file, found.capture.markers.frames, None, found.left_out)
