"""What a run leaves behind: events, plots, pages and recordings for other tools."""
