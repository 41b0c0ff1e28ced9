"""What the source tree itself must show: documentation of its public definitions."""
