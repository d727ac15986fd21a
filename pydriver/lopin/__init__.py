"""Lopin: finite elements for contact in metal forming.

A `Model` (or any `Deck`) says what happens; `run` solves it in this process and returns a `Result`.
Meshes come from `mesh_make` or `read_mesh`, tools from `profile`, reference solutions from
`closed_form`.
"""
from . import closed_form, mesh_make, profile, reference
from .deck import Block, Deck
from .errors import (
    DamagedResultError,
    DeckError,
    InternalError,
    Interrupted,
    LopinError,
    MissingPackageError,
    ModelError,
    NotConvergedError,
    ResourceError,
    SingularError,
    UsageError,
)
from .flow_curves import Chaboche, Hollomon, Kinematic, LinearHardening, Plastic, Swift, Voce
from .folder import Folder
from .friction import (
    AutoFriction,
    Coulomb,
    Cristescu,
    FrictionLaw,
    NortonHoffFriction,
    Orowan,
    Rough,
    StaticKinetic,
    Tresca,
)
from .job import Job
from .job import open_job as open
from .laws import Augmented, Exponential, Lagrange, Penalty, Perturbed, Tabular
from .materials import (
    CowperSymonds,
    Elastic,
    Hill48,
    Material,
    NeoHooke,
    NortonHoff,
    Orientation,
)
from .mesh.mesh import Mesh, together
from .mesh.read import from_meshio, read_mesh
from .model import Model
from .result import Result
from .run import check, run
from .sweep import Case, sweep

__version__ = "0.1.0"
__all__ = [
    "Augmented", "AutoFriction", "Block", "Case", "Chaboche", "Coulomb", "CowperSymonds",
    "Cristescu", "DamagedResultError", "Deck", "DeckError", "Elastic", "Exponential", "Folder",
    "FrictionLaw",
    "Hill48", "Hollomon", "InternalError", "Interrupted", "Job", "Kinematic", "Lagrange",
    "LinearHardening", "LopinError", "Material", "Mesh", "MissingPackageError", "Model",
    "ModelError", "NeoHooke", "NortonHoff", "NortonHoffFriction", "NotConvergedError",
    "Orientation", "Orowan", "Penalty", "Perturbed", "Plastic", "ResourceError", "Result",
    "Rough", "SingularError", "StaticKinetic", "Swift", "Tabular", "Tresca", "UsageError", "Voce",
    "check", "closed_form", "from_meshio", "keywords", "mesh_make", "open", "open_result",
    "profile", "read_mesh", "reference", "run", "sweep", "together",
]


def keywords() -> list[dict]:
    """Rows of the deck language, as the reader of decks knows it."""
    from ._bridge import keywords as rows

    return rows()


def open_result(folder, name=None) -> Result:
    """The result that the executable left in a folder."""
    return Result(Folder(folder, name))
