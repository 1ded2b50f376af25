"""Energy and forces of a scene as a function of positions, and of the box where a fix relaxes it: what minimisers see."""
from __future__ import annotations

import numpy as np

from asemd import live_box
from asemd.kernels import box as live
from asemd.lammps.live_coefficients import live_coefficients


class Landscape:
    """Energy and forces as a function of unwrapped positions, with the fixes that act in minimisations.

    The neighbour list is rebuilt only when some atom has moved more than half the skin.
    """

    def __init__(self, loop, session):
        self.loop, self.system, self.session = loop, loop.system, session
        self.live = live_coefficients(session)
        self.image = loop.system.image.copy()
        self.step = loop.step
        self.next_step = loop.step + 1
        self.x0 = loop.system.x.copy()
        # forces with random numbers are others each time: they are computed as often as LAMMPS does it
        self.random = any(use.style.stirred for use in loop.interactions.uses["pair"])
        self.known = self.random        # whether the next evaluation is where the last one was, and is left out

    def __call__(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        self.place(x)
        return self.evaluate()

    def move(self, v: np.ndarray) -> None:
        """Velocities of damped dynamics, for forces that depend on them."""
        self.system.v[:] = v

    def place(self, x: np.ndarray) -> None:
        """Atoms to unwrapped positions."""
        self.system.x[:] = x - (self.system.image - self.image) @ self.system.box.cell

    def evaluate(self) -> tuple[float, np.ndarray]:
        """Energy and forces where the atoms are."""
        loop, system = self.loop, self.system
        if self.live or self.random:        # variables and temperatures see the step of the iteration
            loop.step = self.session.scene.step = system.step = self.step
        for fix in self.live:
            self.session.moment.forget()
            fix.update(loop)
        loop.trial_step = self.step
        result, self.known = loop.result if self.known else loop.evaluate(), False
        self.step = self.next_step
        fixes = sum(f.scalar() for f in loop.fixes if f.thermo_energy)
        return result.potential + fixes, system.f


class BoxLandscape(Landscape):
    """The same with the degrees of freedom of a box as further rows behind those of the atoms.

    In a line search atoms go with the box from where they were at its start, and along the direction besides.

    Parameters
    ----------
    fix : asemd.fix.box_relax.BoxRelax
    """

    def __init__(self, loop, session, fix):
        super().__init__(loop, session)
        fix.set_reference(loop.system, loop.units.nktv2p, begin=True)
        self.fix, self.n, self.count = fix, loop.system.n, fix.count()
        self.where = self.x0
        self.mask = loop.groups[fix.group] if fix.partial else np.ones(self.n, bool)
        self.x0 = np.vstack([self.x0, np.zeros((-(-self.count // 3), 3))])
        self.start(self.x0)

    def start(self, x: np.ndarray) -> None:
        """A line search begins."""
        box = self.system.box
        self.first, self.base, self.cell, self.origin = x.copy(), self.where.copy(), box.cell.copy(), box.origin.copy()

    def place(self, x: np.ndarray) -> None:
        """Box and atoms to where a step from the start of the line search leads."""
        system, move = self.system, x - self.first
        cell, origin = self.fix.new_box(self.cell, self.origin, move[self.n:].ravel())
        around = system.image - self.image
        inside = self.base - around @ self.cell
        if move[self.n:].any():
            moved = (inside[self.mask] - self.origin) @ np.linalg.inv(self.cell) @ cell + origin
            inside[self.mask] = moved
        system.x[:] = inside + move[:self.n]
        self.where = system.x + around @ cell
        live.changed(self.loop.state, cell, origin)
        live_box.take(self.loop.engine)

    def evaluate(self) -> tuple[float, np.ndarray]:
        energy, forces = super().evaluate()
        of_box, more = self.fix.look(self.loop.snapshot())
        out = np.zeros_like(self.x0)
        out[:self.n] = forces
        out[self.n:].flat[:self.count] = more
        return energy + of_box, out

    def longest(self, direction: np.ndarray) -> float:
        """The longest step along a direction that the box allows."""
        return self.fix.longest(direction[self.n:])

    def accept(self, iteration: int, x: np.ndarray) -> bool:
        """A line search has succeeded; whether the energy is another one now, because the reference box is."""
        if self.fix.nreset and self.fix.deviatoric and iteration % self.fix.nreset == 0:
            self.fix.set_reference(self.system, self.loop.units.nktv2p)
            self.start(x)
            return True
        return False
