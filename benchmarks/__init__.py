"""Measured promises: each module holds one benchmark, whose numbers must stay within stated bounds.

A benchmark is a module of this package with ``run(context: Context) -> list[Check]``; its name on the command
line is the module's name, and the first sentence of its docstring says what it measures.
"""
