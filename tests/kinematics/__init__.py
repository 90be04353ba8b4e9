"""Tests of frames, twists and shares."""
