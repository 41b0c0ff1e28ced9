"""The parts of tuning: tunable settings, the likelihood of a trial, and the result."""
