"""Lets `python -m mbkf` do what the command `mbkf` does."""

import sys

from mbkf.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
