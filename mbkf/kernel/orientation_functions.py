"""Functions of the kernel on orientations (``orientation.c``, ``orientation_course.c``): what they take and give."""

from __future__ import annotations

from typing import Protocol

from mbkf.conventions import Array


class OrientationFunctions(Protocol):
    """Sensors' orientations. Arrays are in C order."""

    def orientation_course(
        self,
        noise: Array,
        start: Array,
        gyro: Array,
        force: Array,
        field: Array | None,
        course: Array,
        smooth: bool,
        /,
    ) -> bool:
        """Fills the course of sensors; whether all covariances were positive.

        Args:
            noise: (24,) the filter's numbers, as :mod:`mbkf.imu.orientation_course` orders them.
            start: (N, 108) states at the first sample.
            gyro: (T, N, 3) rad/s, NaN where missing.
            force: (T, N, 3) m/s², NaN where missing.
            field: (T, N, 3) µT, NaN where missing; None without magnetometers.
            course: (N, T, 16) filled: quaternion, bias, variances.
            smooth: Whether later samples correct earlier ones.
        """
