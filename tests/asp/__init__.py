"""Tests of the engine, on programs about anything but what MARS is about."""
