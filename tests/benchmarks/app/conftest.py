"""A real browser for the tests of this folder."""

from tests.viz.conftest import browser  # noqa: F401 — a fixture
