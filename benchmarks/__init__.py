"""Benchmarks: each prints a table with ratios. All is compiled before anything is timed."""

from v3dcad.warm_up import warm_up

warm_up()
