"""Rule files: their permitted statements, their content, and their errors."""
