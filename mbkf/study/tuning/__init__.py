"""The parts of tuning: what can be tuned, the likelihood of a trial, and what was found."""
