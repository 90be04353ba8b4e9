"""Tests of the code shared by all commands: the worker and the output on a terminal."""
