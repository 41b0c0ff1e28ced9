"""The beginning of the command `mbkf`, and of `python -m mbkf`: Ctrl-C ends it also while its libraries load."""

import signal
import sys


def main() -> int:
    """Runs the command.

    Python would answer Ctrl-C with a traceback of its imports; until the command has its own handler
    (:mod:`mbkf.cli.stopping`), the signal ends the process. One that is ignored, as in a shell's background, stays so.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from mbkf.cli.late_methods import compile_late

    compile_late()
    from mbkf.cli.main import main as command

    return command()


if __name__ == "__main__":
    sys.exit(main())
