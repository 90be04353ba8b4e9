"""Tests of how modules are read from comments in sources."""
