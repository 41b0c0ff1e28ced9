"""What a file states of the kernel's functions is what the kernel takes."""

import inspect

import pytest

from mbkf.kernel.loading import library


def stated_in(functions):
    """Functions that a protocol states, by name."""
    return {name: one for name, one in vars(functions).items() if inspect.isfunction(one) and name[0] != "_"}


def assert_taken(name, function):
    """Of any other number of arguments the kernel says so, before it reads one."""
    taken, found = len(inspect.signature(function).parameters) - 1, getattr(library(), name)
    with pytest.raises(TypeError):
        found(*[None] * (taken + 1))
    if taken > 1:
        with pytest.raises(TypeError):
            found(*[None] * (taken - 1))
        with pytest.raises((TypeError, ValueError, BufferError)) as refused:
            found(*[object()] * taken)
        assert "number of arguments" not in str(refused.value)
