"""Pictures of configurations and specifications: SVG and PNG of our own layout, DOT, Mermaid."""

from mars_asp.draw.picture import Picture, depict

__all__ = ["Picture", "depict"]
