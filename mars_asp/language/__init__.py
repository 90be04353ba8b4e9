"""The text of `.mars` files: read, written and laid out."""

from mars_asp.language.parse import Parsed, parse_file, parse_text
from mars_asp.language.print import print_configuration

__all__ = ["Parsed", "parse_file", "parse_text", "print_configuration"]
