"""Pictures of a structure."""
