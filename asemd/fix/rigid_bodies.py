"""Which atoms form rigid bodies, and what the bodies are: mass, centre, inertia, orientation and motion from their atoms or from a file."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asemd import quaternion
from asemd.compute import erotate_asphere
from asemd.compute.erotate_sphere import INERTIA
from asemd.errors import InputError
from asemd.kernels.rigid import Bodies

BY_BODY = Bodies._fields[:Bodies._fields.index("first")]
NO_INERTIA = 1e-7       # a principal moment below this times the largest is none


@dataclass
class Members:
    """Atom ids of all bodies, one body after the other; atoms of body k are ``first[k]:first[k + 1]``; `label` is its number in files."""

    ids: np.ndarray
    first: np.ndarray
    label: np.ndarray

    @property
    def count(self) -> int:
        return len(self.label)


def by_number(ids: np.ndarray, number: np.ndarray, label: np.ndarray | None = None) -> Members:
    """Atoms with the same number form a body, in the order of the numbers."""
    order = np.argsort(number, kind="stable")
    values, first = np.unique(number[order], return_index=True)
    return Members(ids[order], np.append(first, len(ids)).astype(np.int64), values if label is None else label)


def by_groups(ids: np.ndarray, masks: list[np.ndarray], style: str) -> Members:
    """Each mask (n,) is a body."""
    if (np.sum(masks, axis=0) > 1).any():
        twice = ids[np.flatnonzero(np.sum(masks, axis=0) > 1)[0]]
        raise InputError(f"fix {style}: atom {twice} belongs to more than one rigid body")
    first = np.cumsum([0, *(np.count_nonzero(m) for m in masks)]).astype(np.int64)
    return Members(np.concatenate([ids[m] for m in masks]), first, np.arange(1, len(masks) + 1))


def principal(tensors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (nb, 3), the smallest first, and eigenvectors (nb, 3, 3) as rows, of symmetric matrices, by Jacobi's method.

    Each rotation removes the largest off-diagonal element. Where eigenvalues coincide, as in symmetric bodies, rounding decides on the
    axes, and with them on the errors of a splitting of the rotation: the order of operations here is LAMMPS's, whose axes these are then.
    """
    m, e = tensors.copy(), np.tile(np.eye(3), (len(tensors), 1, 1))
    pairs, all_of = np.array([(0, 1), (0, 2), (1, 2)]), np.arange(len(m))
    for _ in range(60):
        off = np.abs(np.stack([m[:, i, j] for i, j in pairs], axis=1))
        i, j = pairs[off.argmax(axis=1)].T
        a, b, c = m[all_of, i, i], m[all_of, j, j], m[all_of, i, j]
        live = (a + c != a) | (b + c != b)
        if not live.any():
            break
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            kappa = (b - a) / (2.0 * c)
            t = 1.0 / (np.sqrt(1.0 + kappa * kappa) + np.abs(kappa))
        t = np.where(b == a, 1.0, np.where(c == 0.0, 0.0, np.where(kappa < 0.0, -t, t))) * live
        cosine = 1.0 / np.sqrt(1.0 + t * t)
        sine, k = cosine * t, 3 - i - j
        ik, jk = m[all_of, i, k], m[all_of, j, k]
        m[all_of, i, i], m[all_of, j, j] = a - t * c, b + t * c
        m[all_of, i, j] = m[all_of, j, i] = np.where(live, 0.0, c)
        m[all_of, i, k] = m[all_of, k, i] = cosine * ik - sine * jk
        m[all_of, j, k] = m[all_of, k, j] = sine * ik + cosine * jk
        ei, ej, cosine, sine = e[all_of, i], e[all_of, j], cosine[:, None], sine[:, None]
        e[all_of, i], e[all_of, j] = cosine * ei - sine * ej, sine * ei + cosine * ej
    moments = np.einsum("nii->ni", m)
    order = np.tile(np.arange(3), (len(m), 1))
    for k in (0, 1):        # the smallest of the rest changes places with the first of them
        least = k + np.take_along_axis(moments, order, 1)[:, k:].argmin(axis=1)
        order[all_of, k], order[all_of, least] = order[all_of, least], order[all_of, k]
    return np.take_along_axis(moments, order, 1), np.take_along_axis(e, order[:, :, None], 1)


def quaternions(e: np.ndarray) -> np.ndarray:
    """(nb, 4) orientations of axes (nb, 3, 3)."""
    d = np.einsum("nii->ni", e)
    square = np.empty((len(e), 4))
    square[:, 0] = 0.25 * (d.sum(axis=1) + 1.0)
    for k, (a, b) in enumerate(((1, 2), (0, 2), (0, 1)), 1):
        square[:, k] = square[:, 0] - 0.5 * (d[:, a] + d[:, b])
    x, y, z = e[:, 1, 2] - e[:, 2, 1], e[:, 2, 0] - e[:, 0, 2], e[:, 0, 1] - e[:, 1, 0]
    xy, xz, yz = e[:, 0, 1] + e[:, 1, 0], e[:, 0, 2] + e[:, 2, 0], e[:, 1, 2] + e[:, 2, 1]
    four = 4.0 * square
    table = np.stack([np.stack(row, axis=1) for row in ((four[:, 0], x, y, z), (x, four[:, 1], xy, xz), (y, xy, four[:, 2], yz),
                                                        (z, xz, yz, four[:, 3]))], axis=1)
    q = table[np.arange(len(e)), np.argmax(square >= 0.25, axis=1)]
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def build(system, members: Members, style: str, file: dict[int, np.ndarray] | None = None) -> Bodies:
    """The bodies as the atoms of `system` (in sync) have them, or as `file` says.

    Raises
    ------
    InputError
        An atom of a body that is gone, or moments of inertia that the atoms cannot have.
    """
    first, nb = members.first, members.count
    rows = system.index_of(members.ids).astype(np.int64)
    size = np.diff(first)
    body = np.repeat(np.arange(nb), size)
    m, v = system.atom_masses()[rows], system.v[rows]
    r = system.box.unwrap(system.x, system.image)[rows]

    def total(a):       # one atom after the other, as LAMMPS does
        columns = a.reshape(len(a), math.prod(a.shape[1:])).T
        return np.stack([np.bincount(body, column, nb) for column in columns], axis=1).reshape(nb, *a.shape[1:])
    mass = total(m)
    center = total(m[:, None] * r) / mass[:, None]
    image = np.zeros((nb, 3), np.int32)
    given = {k: file[int(n)] for k, n in enumerate(members.label) if int(n) in file} if file else {}
    for k, values in given.items():
        mass[k], center[k], image[k] = values[0], values[1:4], values[16:19].astype(np.int32)
    system.box.wrap(center, image)
    d = system.x[rows] + (system.image[rows] - image[body]) @ system.box.cell - center[body]
    x, y, z = d.T
    xx, yy, zz = m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y)
    xy, xz, yz = -m * x * y, -m * x * z, -m * y * z
    tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3)
    radius, spin, mu = spheres(system, rows)
    own = INERTIA * m * radius**2
    solids, momenta, turned = ellipsoids(system, rows)
    own_axes = quaternion.axes(turned[rows]) if solids.any() else np.zeros((len(rows), 3, 3))
    bodily = own[:, None, None] * np.eye(3) + np.einsum("nki,nk,nkj->nij", own_axes, solids, own_axes)
    tensor = total(tensor + bodily)
    for k, values in given.items():
        xx, yy, zz, xy, xz, yz = values[4:10]
        tensor[k] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    moments, axes = principal(tensor)
    moments[moments < NO_INERTIA * moments.max(axis=1, keepdims=True)] = 0.0
    axes[:, 2] *= np.where(np.einsum("ni,ni->n", np.cross(axes[:, 0], axes[:, 1]), axes[:, 2]) < 0.0, -1.0, 1.0)[:, None]
    place = np.einsum("iab,ib->ia", axes[body], d)
    if not given:
        along = np.einsum("nka,nab,nkb->nk", axes[body], bodily, axes[body])
        _check_moments(moments, total(along + (m * (place**2).sum(axis=1))[:, None] - m[:, None] * place**2), style)
    velocity = total(m[:, None] * v) / mass[:, None]
    momentum = total(m[:, None] * np.cross(d, v) + (own[:, None] * spin[rows] if own.any() else 0.0)
                     + (np.where(solids[:, :1] > 0.0, momenta[rows], 0.0) if solids.any() else 0.0))
    for k, values in given.items():
        velocity[k], momentum[k] = values[10:13], values[13:16]
    moves = np.ones((nb, 6))
    if system.dimension == 2:
        moves[:, 2:5] = 0.0
    box = np.tile(np.concatenate([system.box.origin, system.box.cell.ravel()]), (nb, 1))
    q = quaternions(axes)
    places = quaternion.product(q[body] * (1.0, -1.0, -1.0, -1.0), turned[rows]) if solids.any() else np.zeros((len(rows), 4))
    return Bodies(mass, center, velocity, np.zeros((nb, 3)), np.zeros((nb, 3)), momentum, np.zeros((nb, 3)), moments,
                  np.ascontiguousarray(axes), q, np.zeros((nb, 4)), image.astype(float), moves, np.zeros((nb, 6)),
                  np.zeros((nb, 6)), box, first, rows, place, np.zeros((len(rows), 6)), radius,
                  np.einsum("iab,ib->ia", axes[body], mu[rows]) if len(mu) == system.n and mu[rows].any() else np.zeros((0, 3)), spin, mu,
                  np.hstack([solids, places]), momenta, turned)


def joined(a: Bodies, b: Bodies) -> Bodies:
    """The bodies of `a` and then those of `b`, on atoms of `a`'s system whose rows are to be set."""
    both = {name: np.concatenate([getattr(a, name), getattr(b, name)]) for name in (*BY_BODY, "rows", "place", "virial", "radius", "solid")}
    dipole = [x.dipole if len(x.dipole) else np.zeros(x.place.shape) for x in (a, b)]
    return a._replace(**both, first=np.concatenate([a.first, a.first[-1] + b.first[1:]]),
                      dipole=np.concatenate(dipole) if len(a.dipole) or len(b.dipole) else a.dipole)


def without(b: Bodies, members: Members, stay: np.ndarray) -> tuple[Bodies, Members]:
    """The bodies that `stay` (nb,), and their members."""
    size = np.diff(members.first)
    atoms = np.repeat(stay, size)
    first = np.concatenate([[0], np.cumsum(size[stay])]).astype(np.int64)
    left = {name: getattr(b, name)[stay] for name in BY_BODY}
    left |= {name: getattr(b, name)[atoms] for name in ("rows", "place", "virial", "radius", "solid")}
    return (b._replace(**left, first=first, dipole=b.dipole[atoms] if len(b.dipole) else b.dipole),
            Members(members.ids[atoms], first, members.label[stay]))


def spheres(system, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radii of the atoms of the bodies (m,), angular velocities and dipoles of all atoms (n, 3), of one row where there are none."""
    extra, nothing = system.extra, np.zeros((1, 3))
    return extra["radius"][rows] if "radius" in extra else np.zeros(len(rows)), extra.get("omega", nothing), extra.get("mu", nothing)


def ellipsoids(system, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moments of inertia of the atoms of the bodies (m, 3), 0 for points; angular momenta and orientations of all atoms."""
    extra = system.extra
    if "shape" not in extra:
        return np.zeros((len(rows), 3)), np.zeros((1, 3)), np.zeros((1, 4))
    return erotate_asphere.moments(system)[rows], extra["angmom"], extra["quaternions"]


def finite(b: Bodies) -> np.ndarray:
    """(m,) which atoms turn with their body."""
    return (b.radius > 0.0) | (b.solid[:, 0] > 0.0)


def _check_moments(moments: np.ndarray, again: np.ndarray, style: str) -> None:
    """The atoms in their places have the moments of the body."""
    largest = moments.max(axis=1, keepdims=True)
    wrong = (np.abs(moments - again) > 1e-6 * np.where(largest > 0.0, largest, 1.0)).any(axis=1)
    if wrong.any():
        raise InputError(f"fix {style}: rigid body {np.flatnonzero(wrong)[0] + 1} has bad principal moments of inertia")


def unwrapped(system, b: Bodies, body: np.ndarray) -> np.ndarray:
    """(m, 3) positions of the atoms beside the wrapped centres of their bodies."""
    return system.x[b.rows] + (system.image[b.rows] - b.image[body]) @ system.box.cell


def velocities(b: Bodies, body: np.ndarray) -> np.ndarray:
    """(m, 3) of the atoms; the angular velocities follow the angular momenta."""
    with np.errstate(divide="ignore", invalid="ignore"):
        w = np.where(b.moments > 0.0, np.einsum("nka,na->nk", b.axes, b.momentum) / b.moments, 0.0)
    b.omega[:] = np.einsum("nk,nka->na", w, b.axes)
    solid = np.flatnonzero(b.solid[:, 0] > 0.0)
    if len(solid):
        rows, e = b.rows[solid], quaternion.axes(b.turned[b.rows[solid]])
        b.momenta[rows] = np.einsum("nki,nk,nkj,nj->ni", e, b.solid[solid, :3], e, b.omega[body[solid]])
    turning = b.radius > 0.0
    if turning.any():
        b.spin[b.rows[turning]] = b.omega[body[turning]]
    return np.cross(b.omega[body], np.einsum("na,nab->nb", b.place, b.axes[body])) + b.v[body]


def follow(b: Bodies, origin: np.ndarray, vectors: np.ndarray) -> None:
    """Centres of mass keep their places relative to a box that has changed to this one."""
    new = np.concatenate([origin, vectors.ravel()])
    old = np.flatnonzero((b.box != new).any(axis=1))
    if len(old):
        cells = b.box[old, 3:].reshape(-1, 3, 3)
        fraction = np.linalg.solve(np.swapaxes(cells, 1, 2), (b.x[old] - b.box[old, :3])[:, :, None])[:, :, 0]
        b.x[old], b.box[old] = origin + fraction @ vectors, new


def farthest(system, members: Members) -> float:
    """Largest distance of an atom from the one in the middle of its body."""
    r = system.box.unwrap(system.x, system.image)[system.index_of(members.ids)]
    body = np.repeat(np.arange(members.count), np.diff(members.first))
    low, high = (np.minimum, np.maximum)
    middle = 0.5 * (low.reduceat(r, members.first[:-1], axis=0) + high.reduceat(r, members.first[:-1], axis=0))
    away = ((r - middle[body]) ** 2).sum(axis=1)
    order = np.lexsort((members.ids, away, body))
    owner = order[members.first[:-1]]
    return float(np.sqrt(((r - r[owner][body]) ** 2).sum(axis=1).max()))
