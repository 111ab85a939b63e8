"""Tests; a package, because one that a test dependency installs is called `tests` too."""
