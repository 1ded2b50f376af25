r"""Switch a solid into an Einstein crystal and back, for its free energy by thermodynamic integration.

.. math:: F = (1 - \lambda) F_{solid} - \lambda K (r - r_0), \qquad E = \tfrac12 \sum_i K (r_i - r_{i0})^2

From the step on which the fix is made :math:`\lambda` is 0 for t_equil steps, goes to 1 in t_switch steps, stays there for t_equil steps
and goes back in t_switch steps: linearly (function 1), or as
:math:`\tau^5 (70 \tau^4 - 315 \tau^3 + 540 \tau^2 - 420 \tau + 126)`, whose ends are smooth (function 2). The work is the sum of the
vector's second element times the difference of the energies of both systems.

Source: M. de Koning, A. Antonelli, Phys. Rev. E 53, 465 (1996); R. Freitas, M. Asta, M. de Koning, Comput. Mater. Sci. 112, 333 (2016);
LAMMPS manual, fix ti/spring. Units: K in force/distance. Output: a scalar, the energy of the springs; a vector, :math:`\lambda` and its
change per step.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import number, take, whole, yes_no


def switched(p, step):
    """Lambda of a step and its change per step: into ``p[6]`` and ``p[7]``."""
    t, span, rest = step - p[2] - p[4], p[3], p[4]
    tau, sign = -1.0, 1.0
    if 0.0 <= t <= span:
        tau = t / span
    elif span + rest <= t <= 2.0 * span + rest:
        tau, sign = 1.0 - (t - span - rest) / span, -1.0
    if tau >= 0.0:
        if p[5] == 1.0:
            p[6], p[7] = tau, sign / span
        else:
            square = tau * tau
            p[6] = square * square * tau * (70.0 * square * square - 315.0 * square * tau + 540.0 * square - 420.0 * tau + 126.0)
            p[7] = sign * 630.0 * square * square * (square * square - 4.0 * square * tau + 6.0 * square - 4.0 * tau + 1.0) / span


class TISpring(Fix):
    """Thermodynamic integration to springs.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    k : float
        Spring constant, force/distance units.
    switch, equilibrate : int
        Steps of a switching, and steps before each of them.
    function : int
        1: linear, 2: smooth ends.

    Raises
    ------
    InputError
        Numbers that are not positive, another function.
    """

    style = "ti/spring"
    restarts = ("peratom",)
    size = 2
    extensive = True
    minimizes = True
    levels = "one"

    def __init__(self, group: str = "all", k: float = 1.0, switch: int = 1000, equilibrate: int = 1000, function: int = 1):
        super().__init__(group)
        if not k > 0.0:
            raise InputError(f"fix ti/spring: the spring constant must be positive, got {k:g}")
        if switch < 1 or equilibrate < 0:
            raise InputError(f"fix ti/spring: t_switch must be positive and t_equil not negative, got {switch} and {equilibrate}")
        if function not in (1, 2):
            raise InputError(f"fix ti/spring function: 1 or 2, got {function}")
        self.k, self.switch, self.equilibrate, self.function = k, switch, equilibrate, function
        self.places: np.ndarray | None = None       # (n, 3) unwrapped
        self.p = np.zeros(9)
        self.start = -1

    @classmethod
    def from_lammps(cls, group, words, session):
        k, switch, equilibrate = take(words, 3, "fix ti/spring K t_switch t_equil")
        rest, function = words[3:], 1
        while rest:
            if rest[0] != "function":
                raise InputError(f"fix ti/spring: unknown keyword {rest[0]!r}{nearest(rest[0], ('function',))}")
            function, rest = whole(take(rest[1:], 1, "fix ti/spring function")[0], "fix ti/spring function"), rest[2:]
        fix = cls(group, number(k, "fix ti/spring K"), whole(switch, "fix ti/spring t_switch"), whole(equilibrate, "fix ti/spring t_equil"),
                  function)
        system = session.scene.system
        fix.places, fix.start = system.box.unwrap(system.x, system.image), session.scene.step
        return fix

    def to_lammps(self) -> list[str]:
        return [repr(self.k), str(self.switch), str(self.equilibrate), "function", str(self.function)]

    def modify_option(self, keyword, value, session):
        if keyword == "energy":
            self.thermo_energy = yes_no(value, "fix_modify energy")
            return True
        return super().modify_option(keyword, value, session)

    def parameters(self, loop) -> np.ndarray:
        if self.start < 0:      # made in Python
            self.start = loop.step
        if self.function == 1 and not self.p[6:].any():
            self.p[7] = 1.0 / self.switch
        self.p[:6] = loop.group_bit(self.group), self.k, self.start, self.switch, self.equilibrate, self.function
        return self.p

    def atom_arrays(self, loop) -> np.ndarray:
        system = loop.system
        if self.places is None or len(self.places) != system.n:
            self.places = system.box.unwrap(system.x, system.image)
        return self.places

    @hook(uses=[switched])
    def initial_integrate(th, s, p, a):
        if th.tid == 0:
            switched(p, float(th.step))
        barrier(th)

    @hook
    def post_force(th, s, p, a):
        if th.step - p[2] < p[4]:
            return
        bit, v, share, energy = np.int32(np.int64(p[0])), s.box.vectors, p[6], 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                for d in range(3):
                    x = s.x[d, i] + s.image[row, 0] * v[0, d] + s.image[row, 1] * v[1, d] + s.image[row, 2] * v[2, d]
                    away = x - a[row, d]
                    s.f[d, i] = (1.0 - share) * s.f[d, i] - share * p[1] * away
                    energy += 0.5 * p[1] * away * away
        energy = reduce_sum(th, energy)
        if th.tid == 0:
            p[8] = energy

    def scalar(self) -> float:
        """Energy of the springs, energy units."""
        return float(self.p[8])

    def vector(self, i: int) -> float:
        """1: lambda; 2: its change per step."""
        if i not in (1, 2):
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 2 components, not {i}")
        return float(self.p[5 + i])

    def state(self) -> dict:
        """The places of the springs and the step on which the fix was made."""
        return {"places": self.places, "start": self.start, "numbers": self.p[6:].copy()}

    def restore(self, state: dict) -> None:
        self.places, self.start = np.array(state["places"]), int(state["start"])
        self.p[6:] = state["numbers"]
