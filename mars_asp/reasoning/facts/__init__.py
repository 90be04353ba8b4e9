"""The facts of a configuration and its modules, as rules are given them."""
