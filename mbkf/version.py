"""The version of mbkf: the only place where it is written; the package's metadata reads it from here."""

__version__ = "0.1.0"
