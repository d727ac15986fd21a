"""The same deck on a mesh of smaller cells."""
from .subdivide import Refined, refined

__all__ = ["Refined", "refined"]
