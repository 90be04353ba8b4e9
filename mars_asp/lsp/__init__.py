"""Answers to editors: each a pure function of texts and of what an analysis found."""
