"""Pure array mathematics: Kalman updates, Levenberg–Marquardt, rotations, Cardan angles."""
