"""Ground programs: terms and atoms, independent components, and their optima."""
