"""URDF: links and joints as mounted modules with motion functions, and back.

The meaning of a document is that of http://wiki.ros.org/urdf/XML: metres and radians become
millimetres and degrees. An open bound is written as `OPEN`, because URDF has none, and a bound
as wide as that is read as open.
"""

from mars_asp.exchange.urdf.read import import_urdf, import_urdfs
from mars_asp.exchange.urdf.write import export_urdf, left_out

#: Far above any robot, as meshes have their own files.
MOST_BYTES = 16 * 1024 * 1024

__all__ = ["MOST_BYTES", "export_urdf", "import_urdf", "import_urdfs", "left_out"]
