"""How long a printer is waited for. Every wait has an end."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Patience:
    """How long is waited, in seconds, and how often is asked again."""

    answer: float = 10.0
    """silence before each probe; after one more such silence the print ends"""
    probes: int = 5
    slow: float = 1800.0
    """silence that ends the print while a command is under way that may take minutes"""
    resends: int = 10
    """how often one line is sent again"""
    settle: float = 0.1
    """quiet after a Resend until all answers to earlier lines are taken to be here"""

    def most(self, slow: bool) -> float:
        """The longest silence, s; then the print ends with `no answer`."""
        return self.slow if slow else (self.probes + 1) * self.answer
