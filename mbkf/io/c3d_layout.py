"""Header and structure of the parameters of a C3D file, checked before any of it is decoded.

The layout is that of the C3D manual (c3d.org): a 512-byte header of 16-bit words, a parameter section, then frames of
points (four numbers each) and analog samples, two bytes a number if the point scale is positive, else four.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.c3d_records import ParameterSection, walk_parameters
from mbkf.io.files_read import check_input, opened

BLOCK_BYTES = 512
"""Header, parameters and data begin at multiples of it."""

_KEY = 0x50
_BYTE_ORDERS = {84: "<", 85: "<", 86: ">"}  # Intel, DEC, MIPS
_FIRST_PROCESSOR = 83
"""Processors are counted from it on; some writers leave it away."""
_SIGN_BYTES = {84: 3, 85: 1, 86: 0}
_MOST_NAMED = 4
LAST_FRAME_OF_HEADER = 65535
"""The header's 16-bit words cannot count further; longer files count in TRIAL:ACTUAL_END_FIELD."""


class Processor(Enum):
    """Processor that wrote a file's numbers."""

    INTEL = 84
    DEC = 85
    MIPS = 86

    @property
    def order(self) -> str:
        """Byte order of integers."""
        return ">" if self is Processor.MIPS else "<"

    def integers(self, data: bytes) -> Array:
        """16-bit integers with a sign."""
        return np.frombuffer(data, dtype=f"{self.order}i2").astype(np.float64)

    def floats(self, data: bytes) -> Array:
        """32-bit floats; DEC's have their words exchanged and an exponent that is greater by two (VAX F)."""
        if self is not Processor.DEC:
            with np.errstate(invalid="ignore"):  # NaN stays NaN
                return np.frombuffer(data, dtype=f"{self.order}f4").astype(np.float64)
        words = np.frombuffer(data, dtype="<u2").reshape(-1, 2)
        joined = (words[:, 0].astype(np.uint32) << 16) | words[:, 1]
        exponent = (joined >> 23) & 0xFF
        # Exponents of 1 and 2 lie below the normal numbers of IEEE, and that of 255 is a number as the others.
        values = np.where(exponent > 2, joined - np.uint32(2 << 23), 0).astype(np.uint32).view(np.float32)
        return values.astype(np.float64)


@dataclass(frozen=True)
class C3dLayout:
    """Sizes a C3D header promises.

    Attributes:
        points: Points per frame.
        analog_per_frame: Analog numbers per frame, over all channels.
        channels: Analog channels.
        first_frame: Number of the first frame, counted from 1.
        frames: Frames the header counts (at most 65535).
        data_block: 512-byte block at which the data start, counted from 1.
        bytes_per_number: 2 (integers) or 4 (floats).
        file_bytes: Size of the file.
        processor: 84 Intel, 85 DEC, 86 SGI-MIPS.
        section: The parameters as they stand in the file.
        notes: Remarks on damage and on counts that contradict each other.
    """

    points: int
    analog_per_frame: int
    channels: int
    first_frame: int
    frames: int
    data_block: int
    bytes_per_number: int
    file_bytes: int
    processor: int
    section: ParameterSection = field(default_factory=ParameterSection)
    notes: tuple[str, ...] = ()

    @property
    def bytes_per_frame(self) -> int:
        """Bytes of one frame of data."""
        return (4 * self.points + self.analog_per_frame) * self.bytes_per_number

    @property
    def frames_present(self) -> int:
        """Whole frames for which the file has bytes."""
        return max(self.data_bytes, 0) // self.bytes_per_frame if self.bytes_per_frame else self.frames

    @property
    def data_bytes(self) -> int:
        """Bytes from the data's first block on."""
        return self.file_bytes - (self.data_block - 1) * BLOCK_BYTES

    @property
    def counts_no_further(self) -> bool:
        """True for a trial that reaches the last frame that the header's words can count."""
        return self.first_frame + self.frames > LAST_FRAME_OF_HEADER


def check_layout(path: Path) -> C3dLayout:
    """The sizes in a C3D file's header, which the file's own size has to bear out.

    Raises:
        FileFormatError: The file is missing, empty, not a C3D file or cut short.
    """
    check_input(path, "name a C3D file")
    size = path.stat().st_size
    if size == 0:
        raise FileFormatError(path, "the file is empty; copy or export it again")
    with opened(path) as file:
        header = file.read(BLOCK_BYTES)
        if len(header) < 2 or header[1] != _KEY:
            raise FileFormatError(path, "not a C3D file (its second byte is not 0x50); export it as C3D")
        start = (header[0] - 1) * BLOCK_BYTES
        file.seek(max(start, 0))
        parameters = file.read(4)
    if len(header) < BLOCK_BYTES:
        raise FileFormatError(path, f"cut short inside its header ({size} bytes); copy or export it again")
    if start < BLOCK_BYTES:
        reason = f"its header puts the parameters into block {header[0]}, which is no block after it"
        raise FileFormatError(path, f"{reason}; export it again")
    if len(parameters) < 4:
        raise FileFormatError(
            path, f"cut short before its parameters ({size} bytes); copy or export it again"
        )
    counted = parameters[3] + (_FIRST_PROCESSOR if parameters[3] < _FIRST_PROCESSOR else 0)
    if counted not in _BYTE_ORDERS:
        raise FileFormatError(path, f"not a C3D file (processor type {parameters[3]}); export it as C3D")
    layout = _layout(header, counted, size)
    ends = [start + parameters[2] * BLOCK_BYTES, (layout.data_block - 1) * BLOCK_BYTES]
    if size < min(end for end in ends if end > start or end == ends[0]):
        raise FileFormatError(path, f"cut short inside its parameters ({size} bytes); export it again")
    if layout.frames <= 0 and not layout.bytes_per_frame:
        raise FileFormatError(path, "its header counts no frames; export the trial again")
    return _with_parameters(path, layout, start, parameters[2], _BYTE_ORDERS[counted])


def _with_parameters(path: Path, layout: C3dLayout, start: int, blocks: int, order: str) -> C3dLayout:
    """The layout on which header, parameters and the file's size agree, with the parameters' records."""
    end = max(start + blocks * BLOCK_BYTES, (layout.data_block - 1) * BLOCK_BYTES)
    with opened(path) as file:
        file.seek(start + 4)
        section = file.read(end - start - 4)
    found = walk_parameters(section, order)
    notes = _damage(found)
    layout = _with_data_block(path, replace(layout, section=found), start + 4, blocks, order, notes)
    stated = found.integer("POINT", "USED", order)
    layout = _with_number_size(layout, layout.points if stated is None else stated, notes)
    if stated is not None and stated != layout.points:
        fitting = [count for count in (layout.points, stated) if _fills(replace(layout, points=count))]
        reason = f"POINT:USED is {stated}, the header counts {layout.points}"
        if len(fitting) != 1:
            raise FileFormatError(path, f"{reason} and the file's size does not decide; export it again")
        notes.append(f"{reason} points; {fitting[0]} fill the file")
        layout = replace(layout, points=fitting[0])
    elif stated is None and not _fills(layout):
        reason = f"no POINT:USED, and the header's {layout.points} points do not fill the file"
        raise FileFormatError(path, f"its parameters are damaged ({reason}); export it again")
    elif stated is None:
        notes.append(f"POINT:USED is missing; the header counts {layout.points} points, which fill the file")
    return replace(layout, notes=tuple(notes))


def _with_data_block(
    path: Path, layout: C3dLayout, start: int, blocks: int, order: str, notes: list[str]
) -> C3dLayout:
    """The layout with data that begin after the parameters: by the header, POINT:DATA_START or the section's length.

    The last two hold where they agree and the frames fill the file from there on, and not from the header's block on.
    """
    least = -(-(start + layout.section.length) // BLOCK_BYTES) + 1
    most = layout.file_bytes // BLOCK_BYTES + 1
    stated = layout.section.integer("POINT", "DATA_START", order) or 0
    after = start // BLOCK_BYTES + blocks + 1
    if least <= layout.data_block <= most:
        other = replace(layout, data_block=after)
        if stated != after or after < least or _fills(layout) or not _fills(other):
            return layout
        notes.append(
            f"its header puts the data into block {layout.data_block}; they are read from block {after} on"
        )
        return other
    where = "before its parameters end" if layout.data_block < least else "beyond its end"
    reason = f"its header puts the data into block {layout.data_block}, {where}"
    possible = [block for block in (stated, after) if least <= block <= most]
    if not possible:
        raise FileFormatError(path, f"{reason}; export it again")
    notes.append(f"{reason}; they are read from block {possible[0]} on")
    return replace(layout, data_block=possible[0])


def _with_number_size(layout: C3dLayout, stated: int, notes: list[str]) -> C3dLayout:
    """The layout with the size of a number that fills the file, where the header's scale has another one's sign.

    Half of a file of floats may be as long as one of integers, so that for these POINT:SCALE has to be positive, too.
    """
    counts, scales = {layout.points, stated}, layout.section.found("POINT", "SCALE")
    other = replace(layout, bytes_per_number=6 - layout.bytes_per_number)

    def fills(one: C3dLayout) -> bool:
        return any(_fills(replace(one, points=count)) for count in counts)

    positive = bool(scales) and not _is_negative(scales[-1].data, layout.processor)
    if fills(layout) or not fills(other) or (other.bytes_per_number == 2 and not positive):
        return layout
    kinds = {2: "integers", 4: "floats"}
    notes.append(
        f"the header's scale is that of {kinds[layout.bytes_per_number]}; {kinds[other.bytes_per_number]} fill the file"
    )
    return other


def _is_negative(number: bytes, processor: int) -> bool:
    """Sign of a float: it stands in the last byte on Intel, in the second on DEC, in the first on MIPS."""
    return len(number) >= 4 and bool(number[_SIGN_BYTES[processor]] & 0x80)


def _fills(layout: C3dLayout) -> bool:
    """True for a layout whose frames fill the file to its last block."""
    return layout.points > 0 and 0 <= layout.data_bytes - layout.frames * layout.bytes_per_frame < BLOCK_BYTES


def _damage(section: ParameterSection) -> list[str]:
    """A remark on the damaged records of a section, if there are any."""
    if not section.faults:
        return []
    listed = "; ".join(section.faults[:_MOST_NAMED])
    more = f"; {len(section.faults) - _MOST_NAMED} more" if len(section.faults) > _MOST_NAMED else ""
    return [f"damaged parameters are left out, and the others used: {listed}{more}"]


def _layout(header: bytes, processor: int, size: int) -> C3dLayout:
    order = _BYTE_ORDERS[processor]
    words = struct.unpack(f"{order}256H", header)
    first, last = words[3], words[4]
    return C3dLayout(
        points=words[1],
        analog_per_frame=words[2],
        channels=words[2] // words[9] if words[9] else words[2],
        first_frame=first,
        frames=last - first + 1 if last >= first else 0,
        data_block=words[8],
        bytes_per_number=4 if _is_negative(header[12:16], processor) else 2,
        file_bytes=size,
        processor=processor,
    )
