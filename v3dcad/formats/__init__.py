"""Text and bytes to values and back; opens no port, imports no kernel."""
