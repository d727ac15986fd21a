"""Lopin: finite elements for contact in metal forming."""
from .errors import LopinError

__version__ = "0.1.0"
__all__ = ["LopinError"]
