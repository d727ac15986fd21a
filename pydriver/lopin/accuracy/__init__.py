"""The accuracy that a deck asks for: estimates, finer meshes, smaller increments."""
from .quantity import Quantity
from .reach import Reached, reach

__all__ = ["Quantity", "Reached", "reach"]
