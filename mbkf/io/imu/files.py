"""One door to all files of inertial readings: chooses the format by suffix and content.

A reader of one's own joins the built-in ones by a decorator::

    @register_imu_reader(".log", title="My logger")
    def read_log(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]: ...
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_regular
from mbkf.io.imu.by_quantity import is_by_quantity, read_by_quantity
from mbkf.io.imu.clocks import on_one_clock
from mbkf.io.imu.movella_dot import is_movella_dot, read_movella_dot
from mbkf.io.imu.plausible import plausible_readings
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.session import read_folder, read_together
from mbkf.io.imu.table import read_imu_csv
from mbkf.io.imu.trigno_discover import is_trigno_discover
from mbkf.io.imu.x_imu import is_x_imu, read_x_imu
from mbkf.io.imu.xsens_text import is_xsens, is_xsens_folder, read_xsens, read_xsens_folder
from mbkf.io.readers import FOLDER, FileFormat, FormatRegistry, lazily


@dataclass(frozen=True)
class ImuOptions:
    """Options of a reader of inertial readings.

    Attributes:
        units: Unit by quantity of a table that does not state them, see :func:`mbkf.io.imu.table.read_imu_csv`.
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
        recognises: True for a file of this kind, by its content; None where the suffix decides.

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
    """Read the sensors of a file, or of a folder with a file for each sensor.

    Args:
        path: A file of a form that the table in docs/inertial.md lists, a folder of such files, or a file of another
            registered format.
        units: Units of a table that does not state them, see :func:`mbkf.io.imu.table.read_imu_csv`.
        rate_hz: Sample rate of a file that does not state it.

    Raises:
        FileFormatError: The file is missing, of no known kind, or broken.
        InvalidInput: A unit or rate is missing, or a time or reading is impossible.
        UnknownName: Unknown unit.
    """
    path = Path(path)
    if not path.exists():
        raise FileFormatError(path, "no such file; name a table of inertial readings")
    if not path.is_dir():
        check_regular(path)
    return plausible_readings(IMUS.format_of(path).read(path, ImuOptions(units, rate_hz)), str(path))


def read_imu_session(
    paths: Sequence[str | Path],
    *,
    units: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    started_together: bool = False,
) -> tuple[ImuReadings, ...]:
    """Read the sensors of several files, or folders, on one clock.

    Args:
        paths: The files.
        units: As for :func:`read_imu`.
        rate_hz: As for :func:`read_imu`.
        started_together: All recordings started at the same moment, whatever their clocks say.

    Raises:
        FileFormatError: A file is missing, of no known kind, or broken.
        InvalidInput: A unit or rate is missing, a reading is impossible, or the sensors have no time in common.
        UnknownName: Unknown unit.
    """
    return read_together(
        [Path(path) for path in paths],
        lambda path: read_imu(path, units=units, rate_hz=rate_hz),
        started_together=started_together,
    )


@register_imu_reader(".csv", ".tsv", ".txt", title="table")
def _read_csv(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_imu_csv(path, units=options.units, rate_hz=options.rate_hz)


@register_imu_reader(".csv", ".txt", title="Movella DOT export", recognises=is_movella_dot)
def _read_movella_dot(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_movella_dot(path, options.units, options.rate_hz)


@register_imu_reader(".csv", ".tsv", ".txt", title="Xsens text export", recognises=is_xsens)
def _read_xsens(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return (read_xsens(path, options.rate_hz),)


@register_imu_reader(FOLDER, ".csv", title="recording of x-io's first x-IMU", recognises=is_x_imu)
def _read_x_imu(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_x_imu(path, options.units, options.rate_hz)


def _with_units(module: str, function: str) -> ReadImu:
    read = lazily(module, function)
    return lambda path, options: read(path, options.units)


def _stating_all(module: str, function: str) -> ReadImu:
    """A reader of files that state units and rate themselves."""
    read = lazily(module, function)
    return lambda path, _: read(path)


register_imu_reader(".csv", title="export of Trigno Discover", recognises=is_trigno_discover)(
    _stating_all("imu.trigno_discover", "read_trigno_discover")
)
register_imu_reader(".mvnx", title="Xsens MVN export")(_stating_all("imu.mvnx", "read_mvnx"))
register_imu_reader(".mat", title="MATLAB file of BROAD or qmt")(_stating_all("imu.mat", "read_imu_mat"))
register_imu_reader(".h5", ".hdf5", title="APDM recording")(_stating_all("imu.apdm", "read_apdm"))
register_imu_reader(".cwa", title="Axivity recording")(_stating_all("imu.cwa", "read_cwa"))
register_imu_reader(".xdf", ".xdfz", title="Lab Streaming Layer recording")(
    _with_units("imu.xdf", "read_xdf")
)
register_imu_reader(".c3d", title="C3D file with channels of inertial sensors")(
    _with_units("imu.c3d_channels", "read_c3d_sensors")
)


@register_imu_reader(FOLDER, ".zip", title="recording with a table per quantity", recognises=is_by_quantity)
def _read_by_quantity(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return on_one_clock(read_by_quantity(path, options.units, options.rate_hz))


@register_imu_reader(FOLDER, title="folder of Xsens text exports", recognises=is_xsens_folder)
def _read_xsens_folder(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_xsens_folder(path, options.rate_hz)


@register_imu_reader(FOLDER, title="folder of sensors' files")
def _read_folder(path: Path, options: ImuOptions) -> tuple[ImuReadings, ...]:
    return read_folder(path, IMUS.suffixes, lambda one: IMUS.format_of(check_regular(one)).read(one, options))
