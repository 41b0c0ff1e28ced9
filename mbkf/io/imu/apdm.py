"""APDM's recordings (.h5) of Opal sensors, in the arrangement of Motion Studio and that of Mobility Lab.

Accelerations are m/s², angular velocities rad/s, fields µT, times microseconds since 1970, orientations (scalar first)
sensor → world with z up.

==============================  ============================================
Mobility Lab (version 5 on)     Motion Studio (versions to 4)
==============================  ============================================
``/Sensors/ID/Accelerometer``   ``/Opal_ID/Calibrated/Accelerometers``
``/Sensors/ID/Gyroscope``       ``/Opal_ID/Calibrated/Gyroscopes``
``/Sensors/ID/Magnetometer``    ``/Opal_ID/Calibrated/Magnetometers``
``/Sensors/ID/Time``            ``/Opal_ID/Time``
``/Processed/ID/Orientation``   ``/Opal_ID/Calibrated/Orientation``
``Configuration: Label 0``      ``MonitorLabelList`` beside ``CaseIdList``
==============================  ============================================
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput, ShapeError
from mbkf.io.files_read import check_input
from mbkf.io.hdf5 import DAMAGED, array
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of

_FRAME = "APDM; orientation in the world of the maker's filter, z up"
_NAMES = {"Accelerometer": "acc", "Gyroscope": "gyr", "Magnetometer": "mag"}


def read_apdm(path: Path) -> tuple[ImuReadings, ...]:
    """The sensors of a recording, named by their labels.

    Raises:
        FileFormatError: The file is missing, damaged or no such recording.
    """
    check_input(path, "name a recording of APDM's sensors (.h5)")
    try:
        with h5py.File(path, "r") as file:
            signals = _mobility_lab(file) if "Sensors" in file else _motion_studio(file)
        if not signals:
            raise FileFormatError(path, "no sensors; name a recording of APDM's sensors (.h5)")
        return readings_of(path, signals, frame=_FRAME)
    except (*DAMAGED, ShapeError, InvalidInput) as error:
        raise FileFormatError(path, f"damaged, or no recording of APDM's sensors ({error})") from error


def _mobility_lab(file: h5py.File) -> list[Signal]:
    found = list[Signal]()
    for sensor in file["Sensors"]:
        group = f"Sensors/{sensor}"
        configuration = file[group]["Configuration"].attrs if "Configuration" in file[group] else {}
        label = _text(configuration.get("Label 0", "")) or sensor
        if label in [one.sensor for one in found]:
            label = f"{label} {sensor}"
        times = _times(file, f"{group}/Time")
        found += [
            Signal(label, kind, times, array(file, f"{group}/{name}", float))
            for name, kind in _NAMES.items()
            if name in file[group]
        ]
        key = f"Processed/{sensor}/Orientation"
        if key in file:
            found.append(Signal(label, "quat", times, array(file, key, float)[:, [1, 2, 3, 0]]))
    return found


def _motion_studio(file: h5py.File) -> list[Signal]:
    labels = dict(
        zip(
            (_text(one) for one in np.ravel(file.attrs.get("CaseIdList", []))),
            (_text(one) for one in np.ravel(file.attrs.get("MonitorLabelList", []))),
            strict=False,
        )
    )
    found = []
    for name in file:
        if not name.startswith("Opal_") or "Calibrated" not in file[name]:
            continue
        case = name.removeprefix("Opal_")
        sensor = next((label for key, label in labels.items() if key and key.endswith(case)), "") or case
        times, group = _times(file, f"{name}/Time"), f"{name}/Calibrated"
        found += [
            Signal(sensor, kind, times, array(file, f"{group}/{title}s", float))
            for title, kind in _NAMES.items()
            if f"{title}s" in file[group]
        ]
        if "Orientation" in file[group]:
            found.append(
                Signal(sensor, "quat", times, array(file, f"{group}/Orientation", float)[:, [1, 2, 3, 0]])
            )
    return found


def _times(file: h5py.File, key: str) -> Array:
    """(T,) s since 1970."""
    return 1e-6 * array(file, key, float)


def _text(value: object) -> str:
    """A text that stands in a fixed number of bytes."""
    plain = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return plain.replace("\0", "").strip()
