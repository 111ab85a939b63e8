"""The commands, one file for each group: options in, tables out; they compute nothing."""
