"""The same deck on a mesh of smaller cells, or of cells of second order."""
from .subdivide import Refined, of_second_order, refined, refuse, size_of_refined

__all__ = ["Refined", "of_second_order", "refined", "refuse", "size_of_refined"]
