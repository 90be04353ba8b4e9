"""Tests of the facts that a configuration gives."""
