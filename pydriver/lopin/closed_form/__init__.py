"""Closed-form solutions to compare with: functions of the scene's parameters.

Half-spaces are in `closed_hertz`, bodies and structures in `closed_solids`, exact fields of a
unilateral support in `closed_signorini`, friction in `closed_friction` and `closed_punch`, bulk
forming in `closed_forming`; all are named here.
"""
from .forming import (
    Drawing,
    Upset,
    disc_pressure,
    ring_bore,
    ring_chart,
    strip_pressure,
    strip_pressure_rough,
    upset,
    wire_drawing,
)
from .friction import (
    CattaneoLine,
    MindlinPoint,
    NodeState,
    RotatingSlider,
    arctan_creep,
    capstan,
    cattaneo_line,
    dragged_tractions,
    mindlin_point,
    one_node,
    rotating_slider,
    shrink_fit_torque,
    slider_path,
    stick_slip_energy,
    triangle_unique_below,
    triangle_unique_below_least,
    unique_below,
    wedge_stays,
)
from .hertz import (
    RIGID,
    ConeContact,
    HertzLine,
    HertzPoint,
    boussinesq_disc,
    boussinesq_point,
    cone_punch,
    contact_modulus,
    first_yield_line,
    first_yield_point,
    flat_punch_2d,
    flat_punch_axisymmetric,
    flat_punch_axisymmetric_pressure,
    hertz_line,
    hertz_line_approach,
    hertz_point,
    hertz_point_approach,
    hertz_sphere_plane,
    relative_radius,
)
from .punch import (
    dundurs_rigid,
    punch_stick,
    punch_stick_uncoupled,
    punch_tractions,
)
from .sheet import (
    BentFibres,
    BentSheet,
    StraightStrip,
    air_bending_force,
    bent_fibres,
    bent_sheet,
    considere_strength,
    ideal_cup_force,
)
from .signorini import PlaneField, signorini_singular, signorini_smooth
from .solids import (
    LiftedBeam,
    OneContact,
    Tube,
    bar_with_gap,
    bar_with_gap_augmented,
    lifted_beam,
    nested_rings,
    penalty_error,
    penalty_slope,
    thick_tube,
    two_springs,
)

__all__ = [name for name in dir() if not name.startswith("_")]
