"""Foam."""
