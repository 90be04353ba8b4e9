"""Answers to editors: pure functions of texts and results of analyses."""
