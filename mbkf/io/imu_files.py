"""One door to all files of inertial readings: chooses the reader by what the file is."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.imu import ImuReadings, read_imu_csv
from mbkf.io.imu_mat import read_imu_mat
from mbkf.io.imu_xsens import is_xsens, read_xsens, read_xsens_folder


def read_imu(
    path: str | Path, *, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """Read the sensors of a file, or of a folder of Xsens text exports.

    Args:
        path: CSV table, Xsens text export, MATLAB file of BROAD or qmt, or a folder of Xsens exports.
        units: Units of a table that does not state them, see :func:`mbkf.io.imu.read_imu_csv`.
        rate_hz: Sample rate of a file that does not state it.

    Raises:
        FileFormatError: The file is missing, of no known kind, or broken.
        InvalidInput: A unit or rate is missing.
        UnknownName: Unknown unit.
    """
    path = Path(path)
    if path.is_dir():
        return read_xsens_folder(path, rate_hz)
    if not path.is_file():
        raise FileFormatError(path, "no such file; name a table of inertial readings")
    suffix = path.suffix.lower()
    if suffix == ".mat":
        return read_imu_mat(path)
    if suffix not in (".csv", ".tsv", ".txt"):
        raise FileFormatError(
            path, f"'{suffix}' files hold no inertial readings that mbkf knows; name a .csv, .txt or .mat"
        )
    if is_xsens(path):
        return (read_xsens(path, rate_hz),)
    return read_imu_csv(path, units=units, rate_hz=rate_hz)
