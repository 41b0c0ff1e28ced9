"""Curves over gait cycles as a tidy table: a row per cycle, quantity and per cent, with its standard deviation."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from mbkf.errors import FileFormatError
from mbkf.io.atomic import replacing
from mbkf.io.files_read import check_input, own_files_read, read_bytes
from mbkf.io.results import Reconstruction
from mbkf.io.session import FootEvent
from mbkf.trial.gait.convention import Convention, convention_of_result
from mbkf.trial.gait.convention_angles import ConventionAngles, convention_angles
from mbkf.trial.gait.curves import SideCurve, side_curves
from mbkf.trial.gait.cycles import POINTS, Cycle, find_gait, over_cycle

SIDES, AXES = ("right", "left"), "xyz"

_WORD = pa.dictionary(pa.int32(), pa.string())
SCHEMA = pa.schema(
    [
        ("side", _WORD),
        ("cycle", pa.int32()),
        ("start_s", pa.float64()),
        ("duration_s", pa.float64()),
        ("toe_off_percent", pa.float32()),
        ("measured", pa.bool_()),
        ("valid", pa.bool_()),
        ("quantity", _WORD),
        ("name", _WORD),
        ("unit", _WORD),
        ("percent", pa.int8()),
        ("value", pa.float32()),
        ("sd", pa.float32()),
    ]
)
"""Columns of a trial's curves. side, cycle: whose cycle, and the how-manieth of that side from 1. start_s, duration_s,
toe_off_percent: of the cycle. measured, valid: whether every load in it was measured, and every torque known
(:attr:`Reconstruction.measured`, ``valid``). quantity: angle, torque, power or reaction. name: the coordinate, without
its side, or the axis of the force. percent: 0 to 100 of the cycle. value, sd: in ``unit``. Angles and torques have the
axes and signs of the convention that the result was reconstructed with; those of the midline are as the right side
sees them."""


DIFFERENT = ("value", "sd")
"""Columns that differ in nearly every row."""


def repeated(schema: pa.Schema) -> list[str]:
    """Columns whose distinct values Parquet stores once; for the others it would count these in vain.

    Args:
        schema: The table's.
    """
    return [name for name in schema.names if name not in DIFFERENT]


def read_curves(path: Path) -> pa.Table:
    """Reads a file of :func:`write_curves`.

    Raises:
        FileFormatError: It is missing or damaged.
    """
    with own_files_read():  # a batch replaces its own table
        check_input(path, "delete its folder and run the batch again")
        content = read_bytes(path)
    try:
        return pq.read_table(pa.BufferReader(content), schema=SCHEMA, page_checksum_verification=True)
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = f"damaged ({error}); delete its folder and run the batch again"
        raise FileFormatError(path, reason) from error


def write_curves(r: Reconstruction, path: Path, by_hand: Iterable[FootEvent] | None = None) -> None:
    """Writes the curves of a reconstruction's gait cycles as Parquet; without gait a table without rows.

    Args:
        r: The reconstruction.
        path: The file.
        by_hand: Strikes and toe-offs set by a person; None: those found by the filter or the motion.

    Raises:
        OSError: It cannot be written.
    """
    write_curves_table(curves_of(r, by_hand), path)


def write_curves_table(curves: pa.Table, path: Path) -> None:
    """Writes curves of :data:`SCHEMA` as Parquet with checksums.

    Raises:
        OSError: It cannot be written.
    """
    with replacing(path) as partial, partial.open("wb") as file:
        pq.write_table(
            curves,
            file,
            compression="zstd",
            use_dictionary=repeated(curves.schema),
            write_page_checksum=True,
        )


def curves_of(r: Reconstruction, by_hand: Iterable[FootEvent] | None = None) -> pa.Table:
    """The curves of a reconstruction's gait cycles (:data:`SCHEMA`): those of the cycle's side, and of the trunk.

    Args:
        r: The reconstruction.
        by_hand: Strikes and toe-offs set by a person; None: those found by the filter or the motion.
    """
    gait, convention = find_gait(r, by_hand), convention_of_result(r)
    if gait is None:
        return SCHEMA.empty_table()
    angles, tables = convention_angles(r, convention), []
    for side in range(2):
        cycles = gait.of(side)
        curves = list(_curves(r, side, convention, angles)) if cycles else []
        tables += [_table(r, cycle, number, curves) for number, cycle in enumerate(cycles, start=1)]
    return pa.concat_tables(tables).unify_dictionaries() if tables else SCHEMA.empty_table()


def _curves(
    r: Reconstruction, side: int, convention: Convention, angles: ConventionAngles
) -> Iterator[SideCurve]:
    """Quantities of a side's cycles; reactions are in the laboratory's axes."""
    yield from side_curves(r, side, convention, angles)
    unknown = np.full(len(r.times_s), np.nan)
    for k, axis in enumerate(AXES):
        sd = unknown if r.foot_wrench_sd is None else r.foot_wrench_sd[:, side, k]
        yield SideCurve("reaction", f"force_{axis}", "N", r.foot_wrench[:, side, k], sd, unknown, unknown)


def _table(r: Reconstruction, cycle: Cycle, number: int, curves: list[SideCurve]) -> pa.Table:
    """One cycle's rows."""
    n = len(curves)
    inside = (r.times_s >= cycle.start_s) & (r.times_s <= cycle.end_s)
    values, spreads = (
        np.concatenate([over_cycle(r.times_s, values, cycle) for values in column])
        for column in ([c.value for c in curves], [c.sd for c in curves])
    )

    def same(value: float | np.bool_, kind: type) -> pa.Array:
        return _column(np.full(n * POINTS, value, kind))

    def each(words: list[str]) -> pa.Array:
        distinct = list(dict.fromkeys(words))
        places = np.repeat([distinct.index(word) for word in words], POINTS).astype(np.int32)
        return pa.DictionaryArray.from_arrays(_column(places), _texts(distinct))

    return pa.table(
        {
            "side": each([SIDES[cycle.side]] * n),
            "cycle": same(number, np.int32),
            "start_s": same(cycle.start_s, np.float64),
            "duration_s": same(cycle.seconds, np.float64),
            "toe_off_percent": same(cycle.off_percent, np.float32),
            "measured": same(r.measured[inside].all(), np.bool_),
            "valid": same(r.valid[inside].all(), np.bool_),
            "quantity": each([c.quantity for c in curves]),
            "name": each([c.name for c in curves]),
            "unit": each([c.unit for c in curves]),
            "percent": _column(np.tile(np.arange(POINTS, dtype=np.int8), n)),
            "value": _column(values.astype(np.float32)),
            "sd": _column(spreads.astype(np.float32)),
        },
        schema=SCHEMA,
    )


def _column(values: NDArray[np.generic]) -> pa.Array:
    """Numbers (N,) in memory as Arrow has them; ``pa.array`` loads pandas, which takes longer than to read a trial."""
    bits = np.packbits(values.astype(bool), bitorder="little") if values.dtype == np.bool_ else values
    return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), len(values), [None, pa.py_buffer(bits)])


def _texts(words: list[str]) -> pa.Array:
    """Words as Arrow has them: their bytes, and where each begins (Arrow columnar format, variable-size binary)."""
    encoded = [word.encode() for word in words]
    begins = np.cumsum([0, *map(len, encoded)], dtype=np.int32)
    return pa.StringArray.from_buffers(len(words), pa.py_buffer(begins), pa.py_buffer(b"".join(encoded)))
