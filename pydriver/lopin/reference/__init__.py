"""Independent numpy twins of the Fortran kernels, for verification only: slow, short, exact."""
from ..mesh.shapes import (
    brick_stiffness,
    exponents,
    gradients,
    hooke,
    shape_functions,
    smallest_jacobian,
    strain_matrix,
)
from .contact import (
    closest_on_facet,
    closest_on_segment,
    closest_on_triangle,
    contact_active_set,
    contact_oracle,
    cylinder_gap,
    facet_normal,
    plane_gap,
    profile_gap,
    skyline_ldlt,
    sphere_gap,
)

__all__ = [name for name in dir() if not name.startswith("_")]
