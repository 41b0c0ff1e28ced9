"""Inertial sensors: the questions of ``mbkf imu``, one per file, and sensors beside markers."""
