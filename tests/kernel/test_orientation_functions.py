"""The kernel has every function that is stated of it, with as many arguments."""

import pytest

from mbkf.kernel.loading import library
from mbkf.kernel.orientation_functions import OrientationFunctions
from tests.kernel_functions import assert_taken, stated_in

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

STATED = stated_in(OrientationFunctions)


@pytest.mark.parametrize("name", STATED)
def test_a_function_takes_what_is_stated(name):
    assert_taken(name, STATED[name])
