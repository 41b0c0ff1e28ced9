"""Choice of the captures that are reconstructed in pieces: long C3D files that hold one person."""

from __future__ import annotations

from pathlib import Path

from mbkf.io.c3d_decode import frames_stated
from mbkf.io.c3d_layout import check_layout
from mbkf.io.capture import CAPTURES
from mbkf.io.capture_pieces import CapturePieces
from mbkf.io.emg_on_capture import emg_beside
from mbkf.trial.emg.channels import electromyograms
from mbkf.trial.emg.settings import EmgSettings
from mbkf.trial.long.pieces import LONG_FRAMES, PieceSettings


def long_capture(
    path: str | Path,
    without_plates: tuple[str, ...] = (),
    *,
    lengths: PieceSettings | None = None,
    longer_than: int = LONG_FRAMES,
    **options: str | None,
) -> CapturePieces | None:
    """A capture to be read in pieces; None for one that is reconstructed whole.

    Whole are captures that are not longer than the bound, files that are not C3D, those of several persons, and those
    with electromyograms, in the file or beside it.

    Args:
        path: The capture.
        without_plates: Names of plates that are withheld, and need not be readable.
        lengths: Lengths of the pieces.
        longer_than: Frames up to which a capture is whole.
        options: ``up``, ``unit`` and ``axes`` as of :func:`mbkf.io.capture.read_capture`.

    Raises:
        FileFormatError: The file is no C3D file, or broken.
        InvalidInput: Unit or rate cannot be right, or axes name no axes.
    """
    file, lengths = Path(path), lengths or PieceSettings()
    if not file.is_file() or CAPTURES.format_of(file).title != "C3D" or emg_beside(file) is not None:
        return None
    frames = frames_stated(file, check_layout(file))
    if frames is None or frames <= longer_than:
        return None
    found = CapturePieces.of(file, lengths.look_frames, without_plates, **options)
    if found is None or not found.keeps_vertical:
        return None
    return None if electromyograms(found.look.analog, EmgSettings())[0] else found
