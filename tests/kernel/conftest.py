"""Ways of multiplying matrices that the tests of the kernel share."""

import pytest

from mbkf.kernel.loading import library


@pytest.fixture(params=[True, False], ids=["own vectors", "BLAS"], scope="module")
def products(request):
    """Matrices multiplied by instructions of the kernel's own, where the processor has them, and by BLAS."""
    kernel = library()
    if kernel is None:
        pytest.skip("the kernel is not compiled here")
    kernel.choose_products(request.param)
    if request.param and not kernel.vector_bits():
        pytest.skip("the processor has no 512-bit vectors")
    yield
    kernel.choose_products(True)
