"""Tests of the engine, on programs about topics other than robots."""
