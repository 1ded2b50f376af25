r"""Water with springs for bonds and angle (SPC/Fw), at timesteps from 0.25 to 4 fs.

The three vibrations follow from Wilson's matrices G and F: with :math:`\mu = 1/m`, :math:`c = \cos\theta`, :math:`s = \sin\theta` the
antisymmetric stretch has :math:`\omega^2 = k_r (\mu_H + \mu_O (1 - c))`, the symmetric stretch and the bend are the eigenvalues of

.. math:: \begin{pmatrix} \mu_H + \mu_O (1 + c) & -\sqrt 2 \mu_O s / r \\
          -\sqrt 2 \mu_O s / r & 2 (\mu_H + \mu_O (1 - c)) / r^2 \end{pmatrix} \begin{pmatrix} k_r & 0 \\ 0 & k_\theta \end{pmatrix}

The longest stable timestep is :math:`2 / \omega_{max}`, 2.9 fs: 0.5, 1 and 2 fs hold, 3 and 4 fs do not. The limit is some widths of the
bisection. The energy of velocity Verlet fluctuates as the timestep squared; with 8 molecules at 300 K, sampled at each step over 200 fs,
the exponent is within 0.15 of 2: at 1 fs the next order, :math:`(\omega \Delta t / 2)^2` = 0.12, begins to show.

Source: Y. Wu, H. L. Tepper, G. A. Voth, J. Chem. Phys. 124, 024503 (2006); E. B. Wilson, J. C. Decius, P. C. Cross, Molecular Vibrations
(1955).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, onset, vectors

K_BOND, R, K_ANGLE, THETA = 529.581, 1.012, 37.95, 113.24      # energies K (r - R)^2 and K (theta - THETA)^2, kcal/mol, Angstrom
OXYGEN, HYDROGEN = 15.9994, 1.008
FTM2V = 1.0 / 48.88821291**2        # kcal/mol/Angstrom/amu in Angstrom/fs^2


def longest_step() -> float:
    """2 / omega of the fastest vibration, fs."""
    o, h, c, s = 1.0 / OXYGEN, 1.0 / HYDROGEN, math.cos(math.radians(THETA)), math.sin(math.radians(THETA))
    stretch = 2.0 * K_BOND * (h + o * (1.0 - c))
    cross = -math.sqrt(2.0) * o * s / R
    g = np.array([[h + o * (1.0 + c), cross], [cross, 2.0 * (h + o * (1.0 - c)) / R**2]])
    return 2.0 / math.sqrt(FTM2V * max(stretch, *np.linalg.eigvals(g @ np.diag([2.0 * K_BOND, 2.0 * K_ANGLE])).real))


def water(start, molecules: int, dt: float, stretch: float = 0.0, temperature: float = 0.0):
    """A session with molecules far from one another, one step ahead of its first run."""
    session, half = start(), math.radians(0.5 * THETA)
    x, y = (R + stretch) * math.cos(half), (R + stretch) * math.sin(half)
    lines = []
    for k in range(molecules):
        z, o = 10.0 * k, 3 * k + 1
        lines += [f"create_atoms 1 single 0 0 {z}", f"create_atoms 2 single {x!r} {y!r} {z}",
                  f"create_atoms 2 single {x - 0.3 * stretch!r} {-y!r} {z}", f"create_bonds single/bond 1 {o} {o + 1} special no",
                  f"create_bonds single/bond 1 {o} {o + 2} special no", f"create_bonds single/angle 1 {o + 1} {o} {o + 2} special no"]
    session.commands_string("""
        units real
        atom_style angle
        atom_modify map array
        boundary f f f
        region box block -100 100 -100 100 -100 200
        create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1""")
    session.commands_string(f"mass 1 {OXYGEN}\nmass 2 {HYDROGEN}\npair_style zero 6.0\npair_coeff * *\nbond_style harmonic\n"
                            f"bond_coeff 1 {K_BOND} {R}\nangle_style harmonic\nangle_coeff 1 {K_ANGLE} {THETA}")
    session.commands_string("\n".join(lines))
    session.commands_string(f"""
        {f"velocity all create {temperature} 4711 mom no loop geom" if temperature else ""}
        neighbor 2.0 bin
        neigh_modify delay 0 every 1 check yes
        thermo_modify lost ignore norm no
        fix 1 all nve
        timestep {dt!r}
        run 0""")
    return session


def stays(start, dt: float) -> bool:
    """Whether a vibration of 1e-6 Angstrom stays below 1e-4 Angstrom over 4000 steps, looked at eight times."""
    session = water(start, 1, dt, stretch=1e-6)
    try:
        for _ in range(8):
            session.command("run 500 pre no post no")
            x = vectors(session, "x")
            if not all(abs(np.linalg.norm(x[k] - x[0]) - R) < 1e-4 for k in (1, 2)):
                return False
    except Exception:       # the molecule broke apart; LAMMPS raises its own class
        return False
    return True


def fluctuation(start, dt: float) -> float:
    """Root mean square of the energy around its mean over 200 fs, kcal/mol."""
    session, energies = water(start, 8, dt, temperature=300.0), []
    for _ in range(round(200.0 / dt)):
        session.command("run 1 pre no post no")
        v = vectors(session, "v")
        mass = np.tile([OXYGEN, HYDROGEN, HYDROGEN], 8)
        energies.append(0.5 * float((mass[:, None] * v * v).sum()) / FTM2V + session.get_thermo("pe"))
    return float(np.std(energies))


@case("flexible water",
      Figure("longest stable timestep", 1e-3, "relative distance of the timestep at which a molecule blows up from 2 / omega of its "
             "fastest vibration (2.9 fs); 0.5 to 2 fs hold, 3 and 4 fs do not"),
      Figure("exponent of the energy error, 0.25 to 1 fs", 0.15, "how far the growth of the energy fluctuation with the timestep is from "
             "quadratic; forces that are not the gradient of the energy show here"))
def flexible_water(start):
    exact = longest_step()
    found = onset(lambda dt: stays(start, dt), 2.0, 4.0, 1e-3)
    steps = (0.25, 0.5, 1.0)
    exponent = np.polyfit(np.log(steps), np.log([fluctuation(start, dt) for dt in steps]), 1)[0]
    return {"longest stable timestep": abs(found / exact - 1.0), "exponent of the energy error, 0.25 to 1 fs": abs(exponent - 2.0)}
