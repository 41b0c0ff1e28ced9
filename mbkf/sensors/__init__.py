"""Instruments, laws and priors as blocks: expected readings, their derivatives and their noise."""
