"""The questions of ``mbkf imu``, one per file, and inertial sensors beside markers."""
