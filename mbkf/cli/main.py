"""The command `mbkf`: chooses the subcommand and turns every foreseen failure into one line and an exit code.

A command is a module of this package with ``options(parser)`` and ``run(args) -> int``; a group of commands has
``SUBCOMMANDS`` instead, each the module ``<group>_<name>``. The module's docstring is the help: its first line stands
in the list of commands, the text up to the examples above the options, the rest below. Slow libraries are imported
inside ``run``.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import os
import sys
import textwrap
import warnings
from collections.abc import Sequence
from typing import NoReturn

from mbkf.cli.closed_streams import open_closed_streams
from mbkf.cli.stopping import EXIT_INTERRUPTED, EXIT_TERMINATED, Terminated, ended_by_signal
from mbkf.cli.terminal import guarded_output, show_traceback
from mbkf.errors import MbkfError, MbkfWarning
from mbkf.io.leftovers import remove_held
from mbkf.numerics.postponed import postpone
from mbkf.version import __version__

COMMANDS = (
    "demo", "synth", "info", "scale", "label", "reconstruct", "batch", "replay", "live", "view", "report", "norms",
    "app", "tune", "presets", "observability", "protocol", "imu", "export",
)  # fmt: skip
"""Names of the subcommands, in the order of the help; each is the module ``mbkf.cli.<name>``."""

EXIT_BUG = 1
EXIT_BAD_INPUT = 2
EXIT_PIPE_CLOSED = 141  # 128 + SIGPIPE

TRACEBACK_VARIABLE = "MBKF_TRACEBACK"
"""Environment variable that, when set, shows where an unforeseen error came from."""

_PYTHONS_FORMAT = warnings.formatwarning

GARBAGE_AFTER = 100_000
"""New objects after which Python looks for circles among them. Its own 700 suit programs whose objects come and go;
what a command's libraries make while they load stays."""


class _HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Fills paragraphs to the terminal's width and keeps indented lines, such as examples, as they are."""

    def _fill_text(self, text: str, width: int, _indent: str) -> str:
        paragraphs = text.split("\n\n")
        return "\n\n".join(p if "\n " in p else textwrap.fill(p, width) for p in paragraphs) + "\n"


class OneLineParser(argparse.ArgumentParser):
    """Parser that reports wrong usage on a single line."""

    def __init__(self, **options: object) -> None:
        options.setdefault("formatter_class", _HelpFormatter)
        options.setdefault("allow_abbrev", False)
        super().__init__(**options)  # type: ignore[arg-type]

    def error(self, message: str) -> NoReturn:
        """Prints the fault and the way to the help on one line of stderr, and exits with 2."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: error: {_one_line(message)} (see {self.prog} --help)\n")


class _Version(argparse.Action):
    """Prints version and kernel; the kernel is looked for only when asked."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from mbkf.kernel.loading import kernel_name

        print(f"mbkf {__version__}, {kernel_name()}")
        parser.exit()


def build_parser(commands: Sequence[str] = COMMANDS) -> argparse.ArgumentParser:
    """The parser of the command line with the given commands; no other module is imported."""
    parser = OneLineParser(
        prog="mbkf",
        description="Joint angles, torques and ground reactions, each with its standard deviation, "
        "from motion capture.",
        epilog="Example:\n  mbkf demo\n\n`mbkf COMMAND --help` explains a command and gives an example.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print version and kernel, and exit")
    _add_commands(parser, "command", commands)
    return parser


def _add_commands(parser: argparse.ArgumentParser, dest: str, names: Sequence[str], group: str = "") -> None:
    """Adds the commands of the module ``mbkf.cli.<group><name>`` for each name."""
    subparsers = parser.add_subparsers(dest=dest, metavar="COMMAND", required=True, title="commands")
    for name in names:
        module = importlib.import_module(f"mbkf.cli.{group}{name}")
        about, marker, examples = (module.__doc__ or "").partition("\n\nExample")
        command = subparsers.add_parser(
            name,
            help=about.partition("\n")[0].removesuffix("."),
            description=about,
            epilog=(marker + examples).strip(),
        )
        if hasattr(module, "SUBCOMMANDS"):
            _add_commands(command, f"{name}_command", module.SUBCOMMANDS, f"{name}_")
        else:
            module.options(command)
            command.set_defaults(run=module.run)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line with the given words, or those of ``sys.argv``.

    Returns:
        0 on success, 2 on bad input, 130 when interrupted, 143 when terminated, 1 on a bug in mbkf.

    Raises:
        SystemExit: By argparse: 2 on wrong usage, 0 after ``--help`` and ``--version``.
    """
    gc.set_threshold(GARBAGE_AFTER)
    open_closed_streams()
    if arguments is None:
        sys.excepthook = show_traceback
    with guarded_output():
        return _run(list(sys.argv[1:] if arguments is None else arguments))


def _run(words: list[str]) -> int:
    named = words[:1] if words[:1] and words[0] in COMMANDS else COMMANDS
    args = build_parser(named).parse_args(words)
    out = getattr(args, "out", None)
    if out is not None and not out.strip():  # "" would be the folder that the command is called in
        return _fail("--out is empty; name the folder or file to write")
    from mbkf.cli.inputs import check_outputs, inputs_protected

    postpone()
    warnings.formatwarning = _formatted
    try:
        with ended_by_signal(), inputs_protected(args):
            check_outputs(args)
            code = args.run(args)
            sys.stdout.flush()  # so that a closed pipe is noticed here
        return code
    except MbkfError as error:
        return _fail(_with_commands(str(error), args))
    except KeyboardInterrupt as interruption:
        remove_held()  # where it came while an unfinished file was being removed
        terminated = isinstance(interruption, Terminated)
        return _fail("interrupted", EXIT_TERMINATED if terminated else EXIT_INTERRUPTED)
    except BrokenPipeError:  # the reader of `mbkf info … | head` has left
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_PIPE_CLOSED
    except OSError as error:
        return _fail(_describe(error))
    except Exception as error:
        if os.environ.get(TRACEBACK_VARIABLE):
            raise
        return _fail(
            f"unexpected {type(error).__name__}: {error}. This is a bug in mbkf; please report it with the output "
            f"of the same command under {TRACEBACK_VARIABLE}=1",
            EXIT_BUG,
        )


def _with_commands(message: str, args: argparse.Namespace) -> str:
    """A message whose options are those of the running command, or stand with a command that has them."""
    from mbkf.cli.named_options import OPTION, commands_of, with_commands

    if not OPTION.search(message):
        return message
    command = f"{args.command} {getattr(args, f'{args.command}_command', '')}".strip()
    return with_commands(message, command, dict(commands_of(build_parser())))


def _fail(message: str, code: int = EXIT_BAD_INPUT) -> int:
    print(f"mbkf: error: {_one_line(message)}", file=sys.stderr)
    return code


def _formatted(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, line: str | None = None
) -> str:
    """A warning of mbkf as one line; others as Python has them."""
    if issubclass(category, MbkfWarning):
        return f"mbkf: warning: {_one_line(str(message))}\n"
    return _PYTHONS_FORMAT(message, category, filename, lineno, line)


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _describe(error: OSError) -> str:
    """The operating system's refusal in a sentence: file, reason, remedy."""
    if error.filename is None or error.strerror is None:
        return str(error)
    if isinstance(error, FileExistsError | NotADirectoryError):
        return f"{error.filename}: a file has the name of the folder to write; name another folder"
    if isinstance(error, IsADirectoryError):
        return f"{error.filename}: is a folder; name a file"
    if isinstance(error, PermissionError):
        return f"{error.filename}: permission denied; name a place you may read and write"
    return f"{error.filename}: {error.strerror}"


if __name__ == "__main__":
    sys.exit(main())
