"""Tests of how `.mars` text is read, edited and printed."""
