"""Tests of the engine, on programs without any module or node."""
