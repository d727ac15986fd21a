"""The same as `lopin.mesh.make`, under the name that scripts import."""
from .mesh.make import (  # noqa: F401
    block,
    crowned_block,
    cylinder,
    disc,
    extruded,
    graded,
    merged,
    ring,
    simplices,
)
