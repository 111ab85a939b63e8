"""The version, stated once: pyproject.toml reads it, `.ont` files carry it."""

VERSION = "0.1.0"
