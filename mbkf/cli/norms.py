"""Reference bands of gait, from the laboratory's own sessions.

Examples:
  mbkf norms build results --out norms.toml
"""

SUBCOMMANDS = ("build",)
"""Each is the module ``mbkf.cli.norms_<name>``."""
