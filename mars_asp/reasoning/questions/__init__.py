"""Questions about a configuration, and their answers."""
