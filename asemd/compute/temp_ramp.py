r"""Temperature after a linear profile of flow has been taken off one component of the velocities.

.. math:: v_{ib} = v_{lo} + (v_{hi} - v_{lo}) \max\!\left(0, \min\!\left(1, \frac{c_i - c_{lo}}{c_{hi} - c_{lo}}\right)\right)

is the bias of component b for an atom at the coordinate c.

Source: LAMMPS manual, compute temp/ramp. Units: temperature; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp
from asemd.errors import InputError, nearest
from asemd.words import choice, number, take

COMPONENTS = ("vx", "vy", "vz")


class TempRamp(Temp):
    """Temperature relative to a ramp of velocity.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    velocity : str
        ``vx``, ``vy`` or ``vz``.
    values : (float, float)
        Its bias at the two ends, velocity units.
    coordinate : str
        ``x``, ``y`` or ``z``.
    ends : (float, float)
        Where the ends are, distance units.

    Raises
    ------
    InputError
        The z component in two dimensions, ends that are the same.
    """

    style = "temp/ramp"
    bias = True

    def __init__(self, group: str = "all", velocity: str = "vx", values=(0.0, 0.0), coordinate: str = "x", ends=(0.0, 1.0)):
        super().__init__(group)
        self.component, self.axis = COMPONENTS.index(velocity), "xyz".index(coordinate)
        self.values, self.ends = tuple(values), tuple(ends)
        if self.ends[0] == self.ends[1]:
            raise InputError(f"compute temp/ramp: the two coordinates must differ, got {self.ends[0]:g} twice")

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute temp/ramp"
        vdim, vlo, vhi, cdim, clo, chi = take(words, 6, f"{what} (vdim vlo vhi cdim clo chi)")
        choice(vdim, COMPONENTS, what)
        choice(cdim, "xyz", what)
        lattice, words = True, words[6:]
        while words:
            if words[0] != "units":
                raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], ['units'])}")
            lattice, words = choice(take(words[1:], 1, f"{what} units")[0], ("lattice", "box"), f"{what} units") == "lattice", words[2:]
        scene = session.scene
        if vdim == "vz" and scene.dimension == 2:
            raise InputError(f"{what}: vz cannot be used in a 2d simulation")
        spacings = scene.lattice.spacings if lattice and scene.lattice is not None else np.ones(3)
        v, c = spacings[COMPONENTS.index(vdim)], spacings["xyz".index(cdim)]
        return cls(group, vdim, [float(v * number(w, what)) for w in (vlo, vhi)], cdim, [float(c * number(w, what)) for w in (clo, chi)])

    def to_lammps(self) -> list[str]:
        return [COMPONENTS[self.component], *map(repr, self.values), "xyz"[self.axis], *map(repr, self.ends), "units", "box"]

    def remove_bias(self, state) -> np.ndarray:
        (lo, hi), (first, last) = self.values, self.ends
        v = state.system.v.copy()
        v[:, self.component] -= lo + np.clip((state.system.x[:, self.axis] - first) / (last - first), 0.0, 1.0) * (hi - lo)
        return v
