"""Where mounted modules are, how they move, and which modules carry out a motion."""
