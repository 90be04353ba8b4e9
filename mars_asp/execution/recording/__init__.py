"""Output of a run: events, diagrams, HTML pages and recordings for other tools."""
