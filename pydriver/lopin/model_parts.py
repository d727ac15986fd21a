"""What a model hands back: tools and contact pairs."""
from __future__ import annotations

from dataclasses import dataclass, field

from .friction import Friction
from .laws import Lagrange
from .profile import Profile, Stl


@dataclass(frozen=True)
class Tool:
    """A rigid tool: a surface, elements or points, and its reference node (a set of one)."""

    name: str
    profile: Profile | Stl | None
    reference: tuple[float, ...]
    number: int
    free: tuple[int, ...] = ()
    body: tuple[tuple[str, str], ...] = ()    #: parameters of the *RIGID BODY, but for its node
    node_name: str = ""

    @property
    def node(self) -> str:
        """Name of the node set that holds the reference node."""
        return self.node_name or f"{self.name}_REF"


@dataclass(frozen=True)
class Pair:
    """A contact pair as `Model.contact` took it."""

    number: int
    slave: str
    master: str
    method: Lagrange
    friction: Friction | None
    options: dict = field(hash=False, compare=False)

    @property
    def interaction(self) -> str:
        """Name of its *SURFACE INTERACTION."""
        return f"I{self.number}"
