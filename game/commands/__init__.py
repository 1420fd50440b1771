"""The command line: `pinjoint [MODEL]` opens the window; subcommands, each in a module here, work without one."""
