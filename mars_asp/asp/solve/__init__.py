"""Ground programs: terms and atoms, components, and what is least of each."""
