"""Meshes: cells, shape functions, bodies made or read, named sets."""
from .mesh import Mesh, together

__all__ = ["Mesh", "together"]
