"""Files of the hydrocarbon potentials REBO and AIREBO, and the values between which their splines of coordinations go.

A file is a list of numbers, one in the first word of each line: parameters by pair of elements (CC CH HH), polynomials of the angular
functions, then polynomials of the splines of coordinations. Of these LAMMPS makes its own, whatever the file says, and so do we: cubic
between the values of the papers at whole coordinations, with the slopes given there and else zero.

Sources: S. J. Stuart, A. B. Tutein, J. A. Harrison, J. Chem. Phys. 112, 6472 (2000); D. W. Brenner et al., J. Phys.: Condens. Matter 14,
783 (2002).
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asemd import words as read
from asemd.errors import InputError
from asemd.potential_file import PotentialFile

PAIRS = ("CC", "CH", "HH")
NAMES = [f"{name}_{pair}" for name in ("rcmin", "rcmax", "rcmaxp") for pair in PAIRS] + ["smin", "Nmin", "Nmax", "NCmin", "NCmax"] + \
    [f"{name}_{pair}" for name in ("Q", "alpha", "A") for pair in PAIRS] + \
    [f"{name}_{pair}{k}" for name in ("BIJc", "Beta") for pair in PAIRS for k in (1, 2, 3)] + \
    [f"{name}_{pair}" for name in ("rho", "rcLJmin", "rcLJmax", "bLJmin", "bLJmax", "epsilon", "sigma") for pair in PAIRS] + \
    [f"epsilonT_{ends}" for ends in ("CCCC", "CCCH", "HCCH")]
MORSE = [f"{name}_{pair}" for name in ("epsilonM", "alphaM", "reqM") for pair in PAIRS]
SPLINES = 2 * (5 + 256) + 4 * (7 + 9216)      # numbers that follow the angular functions

# values of P by numbers of carbon and hydrogen neighbours, for a bond to carbon and one to hydrogen
LONE_CC = {
    "airebo": {(0, 2): -0.0005, (0, 3): 0.0161253646, (1, 1): -0.01096, (1, 2): 0.00632624824, (2, 0): -0.027603, (2, 1): 0.00317953083},
    "rebo": {(0, 2): 0.007860700254745, (0, 3): 0.016125364564267, (1, 1): 0.003026697473481, (1, 2): 0.006326248241119,
             (2, 1): 0.003179530830731}}
LONE_CH = {(0, 1): 0.209336732825, (0, 2): -0.064449615432525, (0, 3): -0.303927546346162, (1, 0): 0.01, (1, 1): -0.125123400628709,
           (1, 2): -0.298905245783, (2, 0): -0.1220421462782555, (2, 1): -0.3005291724067579, (3, 0): -0.307584705066}
RADICAL = 0.0049586079
# values by coordinations of both atoms, in either order, for conjugation 1 to 9 (what is not said: the last one); coordination 4 is as 3
PI_CC = {(0, 0): [0.0, 0.0, RADICAL], (0, 1): [0.021693495, RADICAL], (1, 1): [0.0525, -0.00208875, -0.0080428],
         (0, 2): [0.02469883185, -0.0059713345, RADICAL],
         (1, 2): [0.0048247849, 0.015, -0.01, -0.0116889387, -0.0133778774, -0.015066816],
         (2, 2): [0.047224785, 0.011, 0.019852935, 0.0165441125, 0.01323529, 0.0099264675, 0.006617645, 0.0033088225, 0.0],
         (0, 3): [-0.0598994675, -0.0598994675, RADICAL], (1, 3): [0.0, -0.062418376], (2, 3): [-0.0223546915]}
PI_CH = {(1, 1): [-0.05, -0.05, -0.3, -0.05], (0, 2): [0.0, 0.0, 0.0, 0.0, -0.004523893758064], (1, 2): [0.0, -0.25, -0.25, 0.0],
         (1, 3): [-0.1, -0.125, -0.125, -0.1]}
PI_HH = {(1, 1): [0.124915958, 0.0]}
TWIST = {(2, 2): [-0.03514, -0.004048]}
# slopes of the first of these: along the first coordination (along the second by symmetry), along conjugation
BY_FIRST = {(1, 3): [0.0, 0.0187723882, 0.0], (2, 1): [-0.02625, 0.0, 0.0, 0.0, -0.027188], (2, 3): [0.0, 0.031209]}
BY_CONJUGATION = {(1, 1): [0.0, -0.0302715, 0.0], (1, 2): [0.0, 0.0, 0.0, -0.010022, -0.010022, 0.0],
                  (2, 2): [0.0, 0.0, 0.0, -0.003309, -0.003309, -0.003309, -0.003309, -0.003309, 0.0]}


@dataclass
class Hydrocarbons:
    """What a file says.

    Attributes
    ----------
    numbers : dict of str to float
    carbon_ends (5,), few, many (4, 6), hydrogen_ends (4,), hydrogen (3, 6)
        Where the pieces of the angular functions end, and their coefficients, for carbon of few and of many neighbours.
    """

    numbers: dict[str, float]
    carbon_ends: np.ndarray
    few: np.ndarray
    many: np.ndarray
    hydrogen_ends: np.ndarray
    hydrogen: np.ndarray


def read_hydrocarbons(file: PotentialFile, morse: bool, title: str) -> Hydrocarbons:
    """Read a file; `title` is the word that its first lines must have.

    Raises
    ------
    InputError
        It is for another style, too short, or has something else than a number.
    """
    words = [word for line in file.raw[:2] for word in line.replace("/", " ").split()]
    if title not in words:
        raise file.error(f"the file is not one of {title}, which the first or second line must name", 1)
    at, lines = 0, file.lines

    def take(count: int, what: str) -> np.ndarray:
        nonlocal at
        out = np.zeros(count)
        for k in range(count):
            if at == len(lines):
                raise file.error(f"the file ends before {what}", lines[-1][0] if lines else 1)
            number, text = lines[at]
            try:
                out[k] = read.number(text.split()[0], what)
            except InputError as e:
                raise file.error(e.message, number) from None
            at += 1
        return out

    def pieces(count: int, what: str) -> np.ndarray:
        if (n := take(1, what)[0]) != count:
            raise file.error(f"{what}: expected {count} ends of pieces, got {n:g}", lines[at - 1][0])
        return take(count, what)

    names = NAMES + MORSE * morse
    numbers = {name: float(take(1, name)[0]) for name in names}
    ends = pieces(5, "the angular functions of carbon")
    few, many = (take(24, "the angular functions of carbon").reshape(4, 6) for _ in range(2))
    ends_h = pieces(4, "the angular function of hydrogen")
    hydrogen = take(18, "the angular function of hydrogen").reshape(3, 6)
    take(SPLINES, "the splines of coordinations")
    return Hydrocarbons(numbers, ends, few, many, ends_h, hydrogen)


def lone_values(kind: str) -> np.ndarray:
    """P at whole numbers of carbon and hydrogen neighbours, for bonds to carbon and to hydrogen: (2, 5, 5)."""
    out = np.zeros((2, 5, 5))
    for table, values in zip(out, (LONE_CC[kind], LONE_CH)):
        for place, value in values.items():
            table[place] = value
    return out


def _along(values: list[float]) -> np.ndarray:
    """Conjugation 0 (of no bond) to 9."""
    return np.array([0.0, *values, *values[-1:] * (9 - len(values))])


def conjugated_values() -> np.ndarray:
    """Values and slopes along the axes, at whole coordinations of both atoms and conjugation, of the corrections for bonds of CC, CH and HH
    and for twisted CC: (4, 5, 5, 10, 4)."""
    out = np.zeros((4, 5, 5, 10, 4))
    for table, values in zip(out, (PI_CC, PI_CH, PI_HH, TWIST)):
        for (i, j), column in values.items():
            table[i, j, :, 0] = table[j, i, :, 0] = _along(column)
    for table in out[:2]:
        table[4, :4, :, 0], table[:4, 4, :, 0] = table[3, :4, :, 0], table[:4, 3, :, 0]
    for (i, j), column in BY_FIRST.items():
        out[0, i, j, :, 1] = out[0, j, i, :, 2] = _along(column)
    for (i, j), column in BY_CONJUGATION.items():
        out[0, i, j, :, 3] = out[0, j, i, :, 3] = _along(column)
    return out
