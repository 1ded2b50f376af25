"""Force fields that name variables of the script (``v_k``), in expressions or as factors of ``pair_style hybrid/scaled``: their values, at
the start of a run and at each step of it."""
from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import InputError
from asemd.expression import VARIABLE
from asemd.expression_style import ExpressionStyle, fill_variables
from asemd.fix import Fix
from asemd.formula import CONSTANTS
from asemd.formula_functions import MATH
from asemd.hydrogen_bond_term import HydrogenBondTerm
from asemd.lammps.pair_order import pair_order
from asemd.own_term import OwnTerm
from asemd.term import FactorTerm, PairListTerm

if TYPE_CHECKING:
    from asemd.lammps.session import Session
    from asemd.loop import Loop

STEADY = {*CONSTANTS, *MATH, "version"} - {"random", "normal"}


def fill(session: Session, category: str = "") -> list[str]:
    """Put the present values of variables into the expressions of one category or of all; returns the names of these variables."""
    uses = session.scene.interactions.uses
    return fill_variables([use for c in uses if category in ("", c) for use in uses[c]], session.variables.value)


def scale(session: Session) -> list[str]:
    """Put the present values of variables into the factors of ``hybrid/scaled``; returns the names of these variables.

    Raises
    ------
    InputError
        A variable does not exist or is neither of style equal or internal, nor of style atom or atomfile.
    """
    names = []
    for use in session.scene.interactions.uses["pair"]:
        if not isinstance(use.scale, str):
            continue
        name = use.scale[2:]
        style = session.variables.find(name).style
        if style in ("equal", "internal"):
            use.factor = float(session.variables.number(name))
        elif style in ("atom", "atomfile"):
            if not session.running:      # the first forces of a run are those of atoms inside the box
                session.scene.system.box.wrap(session.scene.system.x, session.scene.system.image)
            use.factor = np.asarray(session.variables.per_atom(name, session.scene.system.n), float)
        else:
            raise InputError(f"pair_style hybrid/scaled: variable {name} has style {style}, it must be equal or atom")
        names.append(name)
    return names


def freeze(session: Session) -> list[str]:
    """Put the present values of variables in the place of their names; returns the names of those that may have others at another step.

    Raises
    ------
    InputError
        A factor of ``hybrid/scaled`` with a value for each atom.
    """
    names = [*fill(session), *scale(session)]
    for category, uses in session.scene.interactions.uses.items():
        for use in uses:
            if np.ndim(use.factor):
                raise InputError(f"pair_style hybrid/scaled: with the atom-style variable {use.scale[2:]} as a factor forces are not the "
                                 "gradient of an energy, which a calculator needs: take a number or an equal-style variable")
            if category == "pair":
                use.scale = use.factor
            for values in use.coeff.values() if hasattr(use.style, "fill") else ():
                values["expression"] = VARIABLE.sub(lambda name: f"({session.variables.value(name[1])})", values["expression"])
                values.pop("current", None)
    return [name for name in dict.fromkeys(names) if changes(session, name)]


def defined(session: Session) -> set[str]:
    """Names of the variables that expressions of the force field name, and of those that these are made of."""
    uses = [use for uses in session.scene.interactions.uses.values() for use in uses if hasattr(use.style, "fill")]
    named = [name for use in uses for values in use.coeff.values() for name in VARIABLE.findall(values["expression"])]
    return {word[2:] for name in named for word in session.variables.references(f"v_{name}") if word.startswith("v_")}


def changes(session: Session, name: str) -> bool:
    """Whether a variable may have another value at another step: its formula has more than numbers, functions and other variables."""
    words = session.variables.references(f"v_{name}")
    return any(word not in STEADY and not word.startswith("v_") and not re.fullmatch(r"[eE]\d+", word) for word in words)   # 1e5


class LiveCoefficients(Fix):
    """Puts values of variables into the coefficients of running terms before each force computation."""

    style = "live/coefficients"
    levels = "outermost"

    def __init__(self, session: Session):
        super().__init__("all")
        self.session = session

    def pre_force(self, loop: Loop) -> None:
        loop.sync_out()
        loop.system.step = loop.step
        self.session.moment.forget()
        self.update(loop)

    def update(self, loop: Loop) -> None:
        """Take up the values that the variables have now."""
        fill(self.session)
        scale(self.session)
        for term in loop.engine.terms:
            if isinstance(term, (PairListTerm, FactorTerm, OwnTerm, HydrogenBondTerm)):
                term.scale(loop.engine)
            use = getattr(term, "use", None)
            if use is not None and isinstance(use.style, ExpressionStyle):
                if use.style.bind(use.settings, use.coeff) is not term.style:
                    raise InputError(f"{use.style.category}_style {use.style.name}: an exponent in an expression changes during the run: "
                                     "only other numbers may change")
                term.packed.coeff[:] = use.style.pack(use.settings, use.coeff, term.packed.coeff.shape[1] - 1, None).coeff


def live_coefficients(session: Session) -> list[LiveCoefficients]:
    """What takes up values of variables in the force field, where they change during a run."""
    for name in fill(session, "pair"):
        if changes(session, name):
            raise InputError(f"pair_coeff lepton: the variable {name} changes during the run: an expression of pairs must stay the same")
    return [LiveCoefficients(session)] if any(changes(session, name) for name in (*fill(session), *scale(session))) else []


def own_fixes(session: Session) -> list[Fix]:
    """The fixes that a run needs beside the user's: for expressions with variables whose value changes, and for random numbers of pairs."""
    return [*live_coefficients(session), *pair_order(session)]
