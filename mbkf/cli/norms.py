"""Reference bands of gait, from the laboratory's own sessions, or of other tools.

Examples:
  mbkf norms build results --out norms.toml
  mbkf norms import adults.csv --out adults.toml
"""

SUBCOMMANDS = ("build", "import", "export")
"""Each is the module ``mbkf.cli.norms_<name>``."""
