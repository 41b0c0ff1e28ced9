"""A real browser for the tests of this folder."""

from tests.viz.conftest import browser, flags  # noqa: F401 — fixtures
