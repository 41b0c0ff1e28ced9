"""The command `mbkf`: one file per subcommand, no mathematics."""
