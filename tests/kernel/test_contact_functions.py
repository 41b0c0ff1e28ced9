"""The kernel has every function that is stated of it, with as many arguments."""

import inspect

import pytest

from mbkf.kernel.contact_functions import ContactFunctions
from mbkf.kernel.loading import library

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

STATED = {
    name: one for name, one in vars(ContactFunctions).items() if inspect.isfunction(one) and name[0] != "_"
}


@pytest.mark.parametrize("name", STATED)
def test_a_function_takes_what_is_stated(name):
    """Of any other number of arguments it says so, before it reads one."""
    taken, found = len(inspect.signature(STATED[name]).parameters) - 1, getattr(library(), name)
    with pytest.raises(TypeError):
        found(*[None] * (taken + 1))
    if taken > 1:
        with pytest.raises(TypeError):
            found(*[None] * (taken - 1))
        with pytest.raises((TypeError, ValueError, BufferError)) as refused:
            found(*[object()] * taken)
        assert "number of arguments" not in str(refused.value)
