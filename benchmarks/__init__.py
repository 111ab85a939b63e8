"""Benchmarks: each prints a table with ratios."""
