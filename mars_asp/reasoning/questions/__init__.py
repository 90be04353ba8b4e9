"""What people ask about a configuration, and what answers it."""
