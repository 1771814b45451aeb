"""The subcommands of `hp-gym`, one file each.

A module here imports nothing slow at its top, so that `hp-gym --help` answers at once.
"""
