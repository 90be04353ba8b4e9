"""Parameters of twist_mux and cmd_vel_mux: controllers of a base, their priorities and holds."""

from mars_asp.exchange.twist_mux.read import import_muxes
from mars_asp.exchange.yaml_document import MOST_BYTES

__all__ = ["MOST_BYTES", "import_muxes"]
