"""What the stresses of a mesh miss, beside recovered ones: by element, in energy and of a number.

The energy of the error is that of the difference between recovered and computed stresses
(Zienkiewicz and Zhu, 1987). A number that is the slope of the least energy in a parameter, as the
force on a tool is in its way and a displacement in a force put there, errs by the product of
the errors of the solution and of its slope in that parameter, which is the solution of the dual
problem with the contact as it is.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..mesh.cells import CELLS
from ..mesh.shapes import shape_functions
from .patches import Patches, Samples
from .solids import Group, Solids


@dataclass
class Missed:
    """By element, in the order of the groups.

    Attributes
    ----------
    labels : of the elements
    energy : of the error of stress of the first field, twice
    products : of the error of the first field by that of each field (field, element)
    total : twice the energy of the first field
    unsure : what `products` may be off by (field, element): of what the recovered stresses do not
        fit where stresses are best known, as beside a corner, by the errors, and by itself
    """

    labels: NDArray
    energy: NDArray
    products: NDArray
    total: float
    unsure: tuple[NDArray, NDArray]

    @property
    def relative(self) -> float:
        """Error in energy norm beside the solution [-]."""
        return float(np.sqrt(self.energy.sum()/max(self.total + self.energy.sum(), 1e-300)))


def missed(solids: Solids, fields: list[NDArray]) -> Missed:
    """What displacement fields (node, ndim), in the order of `solids.labels`, miss."""
    labels, energy, products, total, sizes, misfits = [], [], [], 0.0, [], []
    patches = _recovered(solids, fields)
    for k, group in enumerate(solids.groups):
        one = _Element(group, solids.x, fields)
        recovered = patches[k].at(one.place, group.corners, one.share)
        recovered = recovered.reshape(*recovered.shape[:2], len(fields), -1)
        error = [recovered[:, :, f] - one.stress[f] for f in range(len(fields))]
        labels.append(group.labels)
        energy.append((one.volume*group.product(error[0], error[0])).sum(axis=1))
        products.append(np.array([(one.volume*one.product(error, 0, f)).sum(axis=1)
                                  for f in range(len(fields))]))
        sizes.append(np.array([(one.volume*group.product(v, v)).sum(axis=1) for v in error]))
        misfits.append(_misfit(group, solids.x, fields, patches[k], one.volume.sum(axis=1)))
        total += float((one.volume*group.product(one.stress[0], one.stress[0])).sum())
    e, r = np.sqrt(np.abs(np.hstack(sizes))), np.sqrt(np.hstack(misfits))
    return Missed(np.concatenate(labels), np.concatenate(energy), np.hstack(products), total,
                  (np.hypot(e[0]*r, r[0]*e), r[0]*r))


def _misfit(group: Group, x: NDArray, fields: list[NDArray], patches: Patches,
            volume: NDArray) -> NDArray:
    """Twice the energy of what the recovered stresses of each field do not fit of the samples
    (field, element)."""
    own = _samples(group, x, fields)
    family = CELLS[group.cell].family
    share = np.array([shape_functions(family, p)[0] for p in group.best()])
    apart = patches.at(own.x, group.corners, share) - own.values
    apart = apart.reshape(*apart.shape[:2], len(fields), -1)
    return np.array([volume*group.product(apart[:, :, f], apart[:, :, f]).mean(axis=1)
                     for f in range(len(fields))])


class _Element:
    """Fields at the points of the integrals of a group."""

    def __init__(self, group: Group, x: NDArray, fields: list[NDArray]):
        self.group = group
        xi, weight = group.whole()
        shape, dn, self.place, unit = group.geometry(x, xi)
        self.volume = unit*weight
        family = CELLS[group.cell].family
        self.share = np.array([shape_functions(family, p)[0] for p in xi])
        self.stress, self.uneven = [], []
        for u in fields:
            stress, own = group.stress(shape, dn, self.place, u)
            mean = (self.volume*own).sum(axis=1, keepdims=True)/self.volume.sum(
                axis=1, keepdims=True)
            if group.mean:
                stress, own = group.stress(shape, dn, self.place, u, mean)
            if group.inner:
                stress = group.relaxed(x, xi, self.volume, stress)
            self.stress.append(stress)
            self.uneven.append(own - mean if group.mean else np.zeros_like(own))

    def product(self, error: list[NDArray], f: int, g: int) -> NDArray:
        """Of two errors at the points. Where only the mean change of volume has a stress, what the
        points have beside it misses the recovered pressure too."""
        found = self.group.product(error[f], error[g])
        if not self.group.mean:
            return found
        pressure = [error[k][..., :3].mean(axis=-1) for k in (f, g)]
        return found - pressure[0]*self.uneven[g] - pressure[1]*self.uneven[f]


def _recovered(solids: Solids, fields: list[NDArray]) -> list[Patches]:
    """Patches for each group; one for all groups of a material and order."""
    sorted_by: dict[tuple, list[int]] = {}
    for k, group in enumerate(solids.groups):
        sorted_by.setdefault((group.young, group.poisson, group.order), []).append(k)
    found: list[Patches | None] = [None]*len(solids.groups)
    for own in sorted_by.values():
        parts = [_samples(solids.groups[k], solids.x, fields) for k in own]
        wide = max(p.corners.shape[1] for p in parts)
        many = max(p.x.shape[1] for p in parts)
        joined = Samples(*(np.concatenate([_repeated(v, many) for v in values]) for values in
                           ([p.x for p in parts], [p.values for p in parts])),
                         np.concatenate([np.pad(p.corners, ((0, 0), (0, wide - p.corners.shape[1])),
                                                constant_values=-1) for p in parts]),
                         solids.groups[own[0]].order)
        patches = Patches.of(joined, solids.x)
        for k in own:
            found[k] = patches
    return found


def _repeated(values: NDArray, count: int) -> NDArray:
    """As many samples for each cell: those of cells with fewer are taken again."""
    return values[:, np.arange(count) % values.shape[1]]


def _samples(group: Group, x: NDArray, fields: list[NDArray]) -> Samples:
    """Stresses of all fields at the best points, one after the other."""
    shape, dn, place, _ = group.geometry(x, group.best())
    values = [group.stress(shape, dn, place, u)[0] for u in fields]
    return Samples(place, np.concatenate(values, axis=2), group.corners, group.order)
