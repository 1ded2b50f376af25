r"""Targeted dynamics: a constraint leads a group to a known structure.

The distance of the group from the target :math:`x^f`, weighted by mass, goes linearly from what it is at first to what is asked for:

.. math:: \rho = \sqrt{\frac{1}{M} \sum_i m_i (x_i - x^f_i)^2}, \qquad x_i \leftarrow x_i + \gamma\, (x^{old}_i - x^f_i)

with :math:`\gamma` such that :math:`\rho` is met after each step, and :math:`v_i` changed accordingly. Positions are unwrapped. The
fix stands after those that move the atoms.

Source: J. Schlitter, W. Swegat, T. Muelders, J. Mol. Model. 7, 171 (2001); J. Schlitter, M. Klaehn, Mol. Phys. 101, 3439 (2003); LAMMPS
manual, fix tmd. Arguments: rho at the end, file with the target (``id x y z`` or ``id x y z nx ny nz`` after the bounds of its box; gzip
if it ends in .gz), N, file with the statistics every N steps.
"""
from __future__ import annotations

import gzip
import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix, hook
from asemd.fix.forcing import unwrapped
from asemd.fix.output_file import OutputFile, plain
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import number, take, whole

TITLE = "# Step rho_target rho_old gamma_back gamma_forward lambda work_lambda work_analytical\n"
BOUNDS = ("xlo xhi", "ylo yhi", "zlo zhi")


def read_target(path: str) -> dict[int, np.ndarray]:
    """Unwrapped target positions by atom id.

    Raises
    ------
    InputError
        The file cannot be read, a line that does not belong there, images without the bounds of the box.
    """
    try:
        with (gzip.open(path, "rt", encoding="utf-8") if path.endswith(".gz") else open(path, encoding="utf-8")) as file:
            lines = file.read().splitlines()
    except (OSError, UnicodeDecodeError) as e:
        raise InputError(f"fix tmd: cannot read target file {path}: {getattr(e, 'strerror', None) or e}") from None
    length: dict[int, float] = {}
    target: dict[int, np.ndarray] = {}
    widths = set()
    for n, line in enumerate(lines, 1):
        words, where = line.split("#")[0].split(), f"fix tmd: line {n} of {path}"
        if not words:
            continue
        if len(words) == 4 and " ".join(words[2:]) in BOUNDS:
            length[BOUNDS.index(" ".join(words[2:]))] = number(words[1], where) - number(words[0], where)
            continue
        widths.add(len(words))
        if len(words) not in (4, 7) or len(widths) > 1:
            raise InputError(f"{where} must have an atom id and x y z, and nx ny nz on all lines or none, got {line.strip()!r}")
        if len(words) == 7 and len(length) < 3:
            raise InputError(f"{where} has image flags: the bounds xlo xhi, ylo yhi and zlo zhi of their box must come before")
        if len(words) == 4 and length:
            raise InputError(f"{where} has no image flags: the bounds of a box are for those only")
        id = whole(words[0], f"{where}, atom id")
        if id in target:
            raise InputError(f"{where}: atom {id} is there already")
        x = np.array([number(w, where) for w in words[1:4]])
        if len(words) == 7:
            x += [whole(w, where) * length[d] for d, w in enumerate(words[4:])]
        target[id] = x
    return target


class TMD(Fix):
    """Lead atoms to a target structure.

    Parameters
    ----------
    group : str
        The atoms that are led.
    rho : float
        Distance from the target at the end of the run, weighted by mass; distance units of the scene.
    target : mapping of int to sequence of 3 float, or str
        Positions by atom id, unwrapped, or the file that has them.
    every : int
        Steps between two lines of the file; 0: no file.
    file : str
        Where statistics go.

    Raises
    ------
    InputError
        A negative distance or interval, an interval without a file, a bad target file; at the start of a run: atoms without a target.
    """

    style = "tmd"
    needs_atoms = True

    def __init__(self, group: str = "all", rho: float = 0.0, target=None, every: int = 0, file: str = ""):
        super().__init__(group)
        if rho < 0.0:
            raise InputError(f"fix tmd: rho_final must not be negative, got {rho:g}")
        if every < 0 or bool(every) != bool(file):
            raise InputError("fix tmd: N and the file for statistics go together: N above 0 with a file, or N of 0 without one")
        self.rho, self.path, self.target_path = rho, file, target if isinstance(target, str) else ""
        if target is None:
            raise InputError("fix tmd needs target positions")
        self.target = read_target(target) if isinstance(target, str) else {int(k): np.array(v, float) for k, v in target.items()}
        self.interval, self.every = every, max(every, 1)
        self.out = OutputFile(file, "fix tmd") if file else None
        if self.out is not None:
            self.out.write(TITLE)
        self.p = np.zeros(12)
        self.a: np.ndarray | None = None        # where the atoms were last, and the target
        self.ids = np.zeros(0, int)

    @classmethod
    def from_lammps(cls, group, words, session):
        take(words, 3, "fix tmd (rho_final file1 N file2)")
        every = whole(words[2], "fix tmd N")
        if len(words) != (4 if every else 3):
            raise InputError("fix tmd needs rho_final file1 N, and file2 if N is not 0, got " + " ".join(words))
        fix = cls(group, number(words[0], "fix tmd rho_final"), words[1], 0)
        if every:
            if every < 0:
                raise InputError(f"fix tmd: N must not be negative, got {every}")
            fix.interval = fix.every = every
            fix.path = words[3]
            fix.out = OutputFile(words[3], "fix tmd", silent=session.passive)
            fix.out.write(TITLE)
        fix.begin(session.scene.need_system("fix tmd"), session.scene.groups.mask(group))
        return fix

    def to_lammps(self) -> list[str]:
        if not self.target_path:
            raise InputError("fix tmd: a target that was given as positions cannot be written as words; give it as a file")
        return [repr(float(self.rho)), self.target_path, str(self.interval), *([self.path] if self.interval else [])]

    def begin(self, system, mask: np.ndarray) -> None:
        """Take the distance from the target now as the first one."""
        x, aim = system.box.unwrap(system.x, system.image), np.zeros((system.n, 3))
        missing = [int(i) for i in system.id[mask] if int(i) not in self.target]
        if missing:
            raise InputError(f"TMD target file did not list all group atoms: fix tmd, atom {missing[0]}"
                             + (f" in {self.target_path}" if self.target_path else ""))
        aim[mask] = [self.target[int(i)] for i in system.id[mask]]
        m = system.atom_masses()[mask]
        d = (x - aim)[mask]
        first = math.sqrt((m * (d * d).sum(axis=1)).sum() / m.sum()) if len(m) else 0.0
        self.a, self.ids = np.hstack([x, aim]), system.id.copy()
        self.p[1:4] = first, self.rho, first

    def atom_arrays(self, loop) -> np.ndarray:
        system = loop.system
        if not np.array_equal(self.ids, system.id):     # atoms have left, or stand in another order
            order = np.argsort(self.ids)
            at = np.searchsorted(self.ids[order], system.id) if len(order) else np.zeros(0, int)
            if not len(order) or not np.array_equal(self.ids[order[np.minimum(at, len(order) - 1)]], system.id):
                raise InputError(f"fix tmd {self.id}: atoms have come after it was defined; define it anew")
            self.a, self.ids = np.ascontiguousarray(self.a[order[at]]), system.id.copy()
        return self.a

    def parameters(self, loop) -> np.ndarray:
        if self.a is None:
            self.begin(loop.system, loop.groups[self.group])
        self.p[0], self.p[11] = loop.group_bit(self.group), loop.units.ftm2v
        return self.p

    @hook(uses=[unwrapped])
    def initial_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        done = 0.0
        if th.step != th.begin:
            done = (th.step - th.begin) / (th.end - th.begin)
        rho_target, rho_old = p[1] + done * (p[2] - p[1]), p[3]
        qa, qb, qe, mass = 0.0, 0.0, 0.0, 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row, m = s.row[i], s.mass[i]
                mass += m
                for d in range(3):
                    aim = a[row, 3 + d]
                    old, now = a[row, d] - aim, unwrapped(s, i, d) - aim
                    qa += m * old * old
                    qb += m * now * old
                    qe += m * now * now
        mass = reduce_sum(th, mass)
        qa, qb, qe = reduce_sum(th, qa), reduce_sum(th, qb), reduce_sum(th, qe)
        part = 1.0 / mass if mass > 0.0 else 0.0
        qa, qb, qe = qa * part, 2.0 * qb * part, qe * part
        # the smaller root of qa g^2 + qb g + c, for the distance before and the one that is due
        back, forward = 0.0, 0.0
        for k in range(2):
            rho = rho_old if k == 0 else rho_target
            c = qe - rho * rho
            root = math.sqrt(max(qb * qb - 4.0 * qa * c, 0.0))
            large = 0.5 * (-qb - root if qb >= 0.0 else -qb + root)
            g = c / large if qa != 0.0 and large != 0.0 else 0.0
            if k == 0:
                back = g
            else:
                forward = g
        # the constraint force on the way here, by f dot x and by the kinetic part
        pull, kinetic = 0.0, 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row, m = s.row[i], s.mass[i]
                step = forward / th.dt
                for d in range(3):
                    old = a[row, d] - a[row, 3 + d]
                    x = unwrapped(s, i, d)
                    k = x + back * old - a[row, d]
                    kinetic += m * k * k
                    pull += s.f[d, i] * old
                    s.x[d, i] += forward * old
                    s.v[d, i] += step * old
                    a[row, d] = x + forward * old
        pull, kinetic = reduce_sum(th, pull), reduce_sum(th, kinetic)
        if th.tid == 0:
            ftm2v = p[11]
            square = th.dt * th.dt * ftm2v
            p[4], p[5], p[6], p[7] = rho_target, rho_old, back, forward
            p[8] = back * rho_old * mass / square
            p[9] += p[8] * (rho_target - rho_old)
            if rho_old != 0.0:
                p[10] += (-pull - kinetic / square) * (rho_target - rho_old) / rho_old
            p[3] = rho_target
        barrier(th)

    def hooks(self) -> dict[str, bool]:
        found = super().hooks()
        if not self.interval:
            del found["end_of_step"]
        return found

    def end_of_step(self, loop) -> None:
        """A line of statistics."""
        self.out.write(f"{loop.step} " + " ".join(map(plain, self.p[4:11])) + "\n")
