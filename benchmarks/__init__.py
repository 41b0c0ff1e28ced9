"""Benchmarks: measured numbers, each with a stated bound that it has to keep.

A benchmark is a module or a package of this package that defines ``run(context: Context) -> list[Check]``; its name on
the command line is the module's name, and the first sentence of its docstring says what it measures. Modules without
``run`` are shared by several benchmarks or run alone (``picture``, ``screenshots``).
"""
