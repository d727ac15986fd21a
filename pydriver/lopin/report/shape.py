"""The skin of a part over time, small enough to stand in a page: places and fields as 16-bit
numbers between their least and largest values."""
from __future__ import annotations

import base64
from dataclasses import dataclass, field

import numpy as np

from ..errors import ResourceError

#: Bytes of all frames together, before base64.
ROOM = 2_000_000
#: Words of fields of the body that are shown, with what they are called.
FIELDS = {"Mises": "von Mises stress", "PEEQ": "plastic strain", "U": "displacement"}
#: Faces of the cells of a solid, by their corners.
_FACES = {
    "tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                   (3, 0, 4, 7)],
}
_CORNERS = {"tetra": 4, "tetra10": 4, "wedge": 6, "wedge15": 6, "hexahedron": 8, "hexahedron20": 8,
            "triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "line": 2, "line3": 2,
            "vertex": 1}


@dataclass
class Part:
    """Polygons, or lines, and their points and fields in every frame."""
    kind: str                                        # body, contact, tool
    name: str
    meshes: list                                     # polygons; more than one if remeshed
    mesh: list = field(default_factory=list)         # which of them, a number a frame
    places: list = field(default_factory=list)       # a (n, 3) array a frame
    fields: dict = field(default_factory=dict)       # name: an (n,) array a frame

    def faces(self, frame: int) -> list:
        """The polygons of a frame."""
        return self.meshes[self.mesh[frame]]

    def add(self, one: Part) -> None:
        """A frame, of a part that has this one alone."""
        if not self.meshes or one.meshes[0] != self.meshes[-1]:
            self.meshes.append(one.meshes[0])
        self.mesh.append(len(self.meshes) - 1)
        self.places.append(one.places[0])
        for word, values in one.fields.items():
            if word not in ("points", "cells"):
                self.fields.setdefault(word, []).append(values)


@dataclass
class Shape:
    """All parts of a scene and the times of the frames."""
    dimensions: int
    axisymmetric: bool
    times: list
    parts: list
    unread: list = field(default_factory=list)       # times of outputs that are damaged

    def data(self) -> dict:
        """For the viewer: numbers as base64 of little-endian 16-bit words."""
        box = np.array([p.min(axis=0) for part in self.parts for p in part.places if len(p)])
        top = np.array([p.max(axis=0) for part in self.parts for p in part.places if len(p)])
        low, high = box.min(axis=0), top.max(axis=0)
        size = float((high - low).max()) or 1.0
        parts = []
        for part in self.parts:
            fields = {}
            for name, values in part.fields.items():
                least, most = _range(values)
                fields[name] = {"min": least, "max": most,
                                "data": [_pack((v - least)/((most - least) or 1.0))
                                         for v in values]}
            parts.append({"kind": part.kind, "name": part.name,
                          "meshes": [[list(map(int, face)) for face in faces]
                                     for faces in part.meshes], "mesh": part.mesh,
                          "places": [_pack((p - low)/size) for p in part.places],
                          "fields": fields})
        return {"dimensions": self.dimensions, "low": low.tolist(), "size": size,
                "times": list(map(float, self.times)), "parts": parts}


def shapes_of(result) -> Shape | None:
    """The scene of a result; nothing where it wrote no fields."""
    times = result.times
    if not len(times):
        return None
    model = result.summary.get("model", {})
    source, unread = result.source, []
    chosen = list(range(len(times)))
    while chosen:
        try:
            skin = _body(source, chosen[-1])
            break
        except ResourceError:
            unread.append(chosen.pop())
    if not chosen:
        return Shape(3, False, [], [], [times[i] for i in unread])
    names = list(source._frames[chosen[-1]][1])   # parts of the collection
    chosen = _some(chosen, skin, source, names)
    parts: dict = {}
    for index in list(chosen):
        try:
            skin = _body(source, index, skin)
            frame = [(name, skin if name == "solid" else _other(source, index, name))
                     for name in names if name in source._frames[index][1]]
        except ResourceError:
            unread.append(index)
            chosen.remove(index)
            continue
        for name, one in frame:
            parts.setdefault(name, Part(one.kind, one.name, [])).add(one)
    whole = [part for part in parts.values() if len(part.places) == len(chosen)]
    flat = all(not len(p) or float(np.ptp(p[:, 2])) == 0.0 for part in whole for p in part.places)
    return Shape(int(model.get("dimensions") or (2 if flat else 3)),
                 model.get("kind") == "axisymmetric", [times[i] for i in chosen], whole,
                 [times[i] for i in sorted(unread)])


def _some(chosen: list[int], skin: Part, source, names) -> list[int]:
    """As many of the outputs as there is room for."""
    bytes_a_frame = 6*len(skin.places[0])*2 + 1
    for name in names:
        if name != "solid":
            bytes_a_frame += 14*len(source._piece(chosen[-1], name).points)
    most = int(max(2, min(60, ROOM//bytes_a_frame)))
    if len(chosen) <= most:
        return chosen
    return sorted({chosen[int(round(i))] for i in np.linspace(0, len(chosen) - 1, most)})


def _body(source, index: int, last: Part | None = None) -> Part:
    """The skin of the deformable bodies; that of the last frame, if it is of the same mesh."""
    mesh = source._piece(index, "solid")
    cells = [block.data for block in mesh.cells]
    if last is not None and len(last.fields["cells"]) == len(cells) and \
            all(np.array_equal(a, b) for a, b in zip(last.fields["cells"], cells)):
        faces, points = last.meshes[0], last.fields["points"]
    else:
        faces, points = _skin(mesh)
    part = Part("body", "body", [faces], [0], [_moved(mesh)[points]],
                {"points": points, "cells": cells})
    for word, shown in FIELDS.items():
        if word in mesh.point_data:
            values = np.asarray(mesh.point_data[word], float)
            part.fields[shown] = (np.linalg.norm(values, axis=1) if values.ndim == 2 and
                                  values.shape[1] > 1 else values.ravel())[points]
    return part


def _other(source, index: int, name: str) -> Part:
    """A contact surface or a tool."""
    mesh = source._piece(index, name)
    kind, _, plain = name.partition(" ")
    faces = [tuple(cell[:_CORNERS[block.type]]) for block in mesh.cells for cell in block.data]
    part = Part(kind, plain, [faces], [0], [_moved(mesh)])
    if kind == "contact":
        for word, shown in (("CPRESS", "contact pressure"), ("CSTATUS", "contact status"),
                            ("COPEN", "gap"), ("SLIP_PATH", "path of slip")):
            if word in mesh.point_data:
                part.fields[shown] = np.asarray(mesh.point_data[word], float).ravel()
        if {"CPRESS", "R_n", "R_t"} <= set(mesh.point_data):   # forces of one area
            normal, sheared = (np.linalg.norm(mesh.point_data[word], axis=1)
                               for word in ("R_n", "R_t"))
            share = np.divide(sheared, normal, out=np.zeros(len(normal)), where=normal > 0.0)
            part.fields["friction traction"] = share*np.abs(part.fields["contact pressure"])
    return part


def _moved(mesh) -> np.ndarray:
    """Points where they are: those of the body by their displacement."""
    places = np.zeros((len(mesh.points), 3))
    places[:, :mesh.points.shape[1]] = mesh.points
    if "U" in mesh.point_data:
        u = np.asarray(mesh.point_data["U"], float)
        places[:, :u.shape[1]] += u
    return places


def _skin(mesh) -> tuple[list, np.ndarray]:
    """Faces that one cell alone has, by their corners, and the points that they use."""
    faces = []
    for block in mesh.cells:
        kind = next((k for k in _FACES if block.type.startswith(k)), None)
        if kind is None:
            if _CORNERS.get(block.type, 0) >= 3:
                faces += [tuple(cell[:_CORNERS[block.type]]) for cell in block.data]
            continue
        seen: dict = {}
        for cell in block.data:
            for corners in _FACES[kind]:
                face = tuple(int(cell[k]) for k in corners)
                seen.setdefault(tuple(sorted(face)), []).append(face)
        faces += [found[0] for found in seen.values() if len(found) == 1]
    points = np.unique([k for face in faces for k in face]).astype(int)
    place = {int(k): i for i, k in enumerate(points)}
    return [tuple(place[int(k)] for k in face) for face in faces], points


def _range(values) -> tuple[float, float]:
    """Least and largest of a field over all frames."""
    finite = [v[np.isfinite(v)] for v in values if len(v)]
    least = min((float(v.min()) for v in finite if len(v)), default=0.0)
    most = max((float(v.max()) for v in finite if len(v)), default=0.0)
    return least, most


def _pack(shares: np.ndarray) -> str:
    """Numbers from 0 to 1 as base64 of 16-bit words."""
    words = np.nan_to_num(np.clip(np.asarray(shares), 0.0, 1.0)*65535.0).round().astype("<u2")
    return base64.b64encode(words.tobytes()).decode()
