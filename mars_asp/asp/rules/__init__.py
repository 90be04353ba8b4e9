"""Rule files: what may stand in them, what they say, and what is wrong with them."""
