"""Inertial sensors: orientation filters, virtual IMUs, joint angles, stride length."""
