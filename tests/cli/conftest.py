"""Fixtures of the tests that call the command line."""

import pytest

from tests.captures import Person, write_person


@pytest.fixture(scope="session")
def person(tmp_path_factory) -> Person:
    """Captures, ground reactions and subject of one made person; nobody writes there."""
    return write_person(tmp_path_factory.mktemp("person"))
