"""Every curve of a session as a tidy table: a row for each cycle, quantity and per cent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from mbkf.errors import InvalidInput
from mbkf.io.atomic import replacing
from mbkf.study.session.cycles import Key, SideCycles
from mbkf.study.session.records import MovementGroup, Session
from mbkf.trial.gait.cycles import POINTS

SIDES = ("right", "left")

SCHEMA = pa.schema(
    [
        ("session", pa.string()),
        ("kind", pa.string()),
        ("trial", pa.string()),
        ("side", pa.string()),
        ("start_s", pa.float32()),
        ("duration_s", pa.float32()),
        ("toe_off_percent", pa.float32()),
        ("measured", pa.bool_()),
        ("valid", pa.bool_()),
        ("quantity", pa.string()),
        ("name", pa.string()),
        ("unit", pa.string()),
        ("percent", pa.int8()),
        ("value", pa.float32()),
        ("sd", pa.float32()),
        ("sd_shift", pa.float32()),
    ]
)
"""Columns. kind: of the movement. side: whose cycle. start_s, duration_s, toe_off_percent: of the cycle. measured,
valid: whether a plate of its own measured that foot throughout, and whether the leg's torques are known. quantity:
angle, torque, power, reaction, emg (envelope, V) or emg_active (1 where the muscle is active). name: the coordinate or
muscle without its side, the joint of a whole power, or the direction of a force. value, sd, sd_shift: in ``unit``;
sd_shift is the part of sd that repeats in the same posture, and so shifts all cycles alike. Angles of the midline are
as that side sees them."""

SUFFIXES = (".csv", ".parquet")


def curves_table(session: Session) -> pa.Table:
    """All cycles of a session (:data:`SCHEMA`)."""
    tables = [
        _table(session, gait, side, key)
        for gait in session.gaits
        for side in gait.sides
        for key in side.curves
    ]
    return pa.concat_tables(tables) if tables else SCHEMA.empty_table()


def check_curves_file(path: Path) -> None:
    """Refuses a name that no table can be written to.

    Raises:
        InvalidInput: It ends in neither ``.csv`` nor ``.parquet``.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise InvalidInput(f"{path}: curves are written as {' or '.join(SUFFIXES)}")


def write_session_curves(session: Session, path: str | Path) -> None:
    """Writes all cycles, whole or not at all: CSV or Parquet by the file's ending.

    Raises:
        InvalidInput: It ends in neither ``.csv`` nor ``.parquet``.
        OSError: The file cannot be written.
    """
    target = Path(path)
    check_curves_file(target)
    table = curves_table(session)
    with (
        replacing(target) as partial,
        partial.open("wb") as file,
    ):  # Arrow takes no name of other bytes than UTF-8
        if target.suffix.lower() == ".csv":
            pa_csv.write_csv(table, file)
        else:
            pq.write_table(table, file, compression="zstd")


def _table(session: Session, gait: MovementGroup, side: SideCycles, key: Key) -> pa.Table:
    curves, count = side.curves[key], len(side.cycles)

    def each(values: list[object]) -> list[object]:
        return [value for value in values for _ in range(POINTS)]

    def same(value: object) -> list[object]:
        return [value] * (count * POINTS)

    columns: dict[str, object] = {
        "session": same(session.name),
        "kind": same(gait.kind.value),
        "trial": each([c.trial for c in side.cycles]),
        "side": same(SIDES[side.side]),
        "start_s": each([c.cycle.start_s for c in side.cycles]),
        "duration_s": each([c.cycle.seconds for c in side.cycles]),
        "toe_off_percent": each([c.cycle.off_percent for c in side.cycles]),
        "measured": each([c.measured for c in side.cycles]),
        "valid": each([c.valid for c in side.cycles]),
        "quantity": same(key.quantity),
        "name": same(key.name),
        "unit": same(curves.unit),
        "percent": np.tile(np.arange(POINTS, dtype=np.int8), count),
        "value": curves.values.astype(np.float32).ravel(),
        "sd": curves.sd.astype(np.float32).ravel(),
        "sd_shift": curves.shift_sd.astype(np.float32).ravel(),
    }
    return pa.table(columns, schema=SCHEMA)
