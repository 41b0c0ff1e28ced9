"""One door to all files of inertial readings: chooses the format by suffix and content.

A reader of one's own joins the built-in ones by a decorator::

    @register_imu_reader(".log", title="My logger")
    def read_log(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]: ...
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.imu import ImuReadings, read_imu_csv
from mbkf.io.imu_xsens import is_xsens, read_xsens, read_xsens_folder
from mbkf.io.plausible_imu import plausible_readings
from mbkf.io.readers import FOLDER, FileFormat, FormatRegistry


@dataclass(frozen=True)
class ImuOptions:
    """How a file of inertial readings is read.

    Attributes:
        units: Unit by quantity of a table that does not state them, see :func:`mbkf.io.imu.read_imu_csv`.
        rate_hz: Sample rate of a file that does not state it.
    """

    units: Mapping[str, str] | None = None
    rate_hz: float | None = None


ReadImu = Callable[[Path, ImuOptions], tuple[ImuReadings, ...]]


@dataclass(frozen=True, kw_only=True)
class ImuFormat(FileFormat):
    """A format of inertial readings; ``read`` reads a file."""

    read: ReadImu


IMUS: FormatRegistry[ImuFormat] = FormatRegistry("inertial readings")


def register_imu_reader(
    *suffixes: str, title: str, recognises: Callable[[Path], bool] | None = None
) -> Callable[[ReadImu], ReadImu]:
    """Decorator that registers the reader of a format of inertial readings.

    Args:
        suffixes: Lower-case endings of its files, each with its dot, or :data:`mbkf.io.readers.FOLDER`.
        title: Name of the format, for people.
        recognises: Whether a file of such a suffix is of this kind; None where the suffix decides.

    Raises:
        InvalidInput: A suffix is not one, or is taken.
    """

    def register(read: ReadImu) -> ReadImu:
        IMUS.add(ImuFormat(title=title, suffixes=suffixes, recognises=recognises, read=read))
        return read

    return register


def read_imu(
    path: str | Path, *, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """Read the sensors of a file, or of a folder of Xsens text exports.

    Args:
        path: CSV table, Xsens text export, MATLAB file of BROAD or qmt, a folder of Xsens exports, or a file of
            another registered format.
        units: Units of a table that does not state them, see :func:`mbkf.io.imu.read_imu_csv`.
        rate_hz: Sample rate of a file that does not state it.

    Raises:
        FileFormatError: The file is missing, of no known kind, or broken.
        InvalidInput: A unit or rate is missing, or a time or reading is impossible.
        UnknownName: Unknown unit.
    """
    path = Path(path)
    if not path.exists():
        raise FileFormatError(path, "no such file; name a table of inertial readings")
    return plausible_readings(IMUS.format_of(path).read(path, ImuOptions(units, rate_hz)), str(path))


@register_imu_reader(".csv", ".tsv", ".txt", title="table")
def _read_csv(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_imu_csv(path, units=options.units, rate_hz=options.rate_hz)


@register_imu_reader(".csv", ".tsv", ".txt", title="Xsens text export", recognises=is_xsens)
def _read_xsens(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return (read_xsens(path, options.rate_hz),)


@register_imu_reader(".mat", title="MATLAB file of BROAD or qmt")
def _read_mat(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:  # noqa: ARG001  (the file states all)
    from mbkf.io.imu_mat import read_imu_mat

    return read_imu_mat(path)


@register_imu_reader(FOLDER, title="folder of Xsens text exports")
def _read_xsens_folder(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_xsens_folder(path, options.rate_hz)
