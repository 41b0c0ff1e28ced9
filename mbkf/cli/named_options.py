"""Options that messages name: one that the running command lacks stands with the commands that have it."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Mapping

OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*[a-z]")
"""An option in a sentence."""

MOST_COMMANDS = 3
"""Commands that are named for one option."""


def commands_of(parser: argparse.ArgumentParser, name: str = "") -> Iterator[tuple[str, frozenset[str]]]:
    """Long options of every command of a parser, by its name ("imu orient")."""
    groups = [one for one in parser._actions if isinstance(one, argparse._SubParsersAction)]
    for group in groups:
        for word, inner in group.choices.items():
            yield from commands_of(inner, f"{name} {word}".strip())
    if not groups:
        yield (
            name,
            frozenset(word for one in parser._actions for word in one.option_strings if word[:2] == "--"),
        )


def with_commands(message: str, command: str, options: Mapping[str, frozenset[str]]) -> str:
    """A message with the commands of the options that the running one lacks.

    Options stay as they are where the message names a command that has them ("scale with --mass KG").

    Args:
        message: The message.
        command: The running command.
        options: Long options of every command.
    """
    own = options.get(command, frozenset())
    remarks = []
    for option in dict.fromkeys(OPTION.findall(message)):
        have = [name for name, known in options.items() if option in known]
        named = any(re.search(rf"\b{re.escape(name)}\b", message) for name in have)
        if option not in own and have and not named:
            more = ", …" if len(have) > MOST_COMMANDS else ""
            remarks.append(
                f"{option} is an option of {', '.join(f'mbkf {one}' for one in have[:MOST_COMMANDS])}{more}"
            )
    return "; ".join([message, *remarks])
