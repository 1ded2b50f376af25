"""Change coefficients of the force field, charges or diameters during a run, by variables.

``pair STYLE COEFFICIENT I J v_name``, ``bond|angle|dihedral|improper STYLE COEFFICIENT TYPE v_name``, ``atom charge|diameter v_name``,
``kspace v_name`` (a factor of the Coulomb part of the long-range solver, 1 again in a run without it); on the first step of a run and on
multiples of N (N = 0: on the first step only). ``pair lj/cut:2`` is the second one of that name in a hybrid style. ``scale yes``: the
variable multiplies what the coefficient was. Pairs of types without own coefficients are mixed from the new ones. ``reset yes``: after
each run all is as it was. Masses follow diameters and densities stay, unless ``mass no``. LAMMPS's ewald/disp keeps the energy of charges
by themselves as it was when the run began; here it follows.

Source: LAMMPS manual, fix adapt.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._perturbed import held, spelled, uses_of
from asemd.engine import Engine
from asemd.errors import InputError, nearest
from asemd.fix import Fix, sampled
from asemd.fix.formula import Formula
from asemd.kspace.ewald import choose_waves
from asemd.kspace.term import KSpaceTerm
from asemd.pairstyle import largest_radii
from asemd.population import recharge, retie
from asemd.term import rewind
from asemd.words import bounds, take, whole, yes_no

BONDED = ("bond", "angle", "dihedral", "improper")
OPTIONS = {"reset": 1, "scale": 1, "mass": 1}


class Adapt(Fix):
    """Change coefficients during a run.

    Parameters
    ----------
    group : str
        The atoms whose charges or diameters change.
    every : int
        Steps between two changes; 0: only when a run begins.
    pair : sequence of (style, coefficient, i, j, value)
        `i` and `j`: types, or ranges such as ``"*"`` and ``"1*3"``; values are functions of the loop that return a number.
    bond, angle, dihedral, improper : sequence of (style, coefficient, type, value)
    charge, diameter : callable, optional
        Functions of the loop that return a number or one per atom.
    kspace : callable, optional
        A function of the loop that returns the factor of the long-range solver.
    scale, reset, mass : bool
        Values are factors; what was changed goes back after a run; masses follow diameters.

    Raises
    ------
    InputError
        Nothing to change, a negative interval; in a run: a style or coefficient that is not there.
    """

    style = "adapt"
    levels = "outermost"

    def __init__(self, group: str = "all", every: int = 1, pair=(), bond=(), angle=(), dihedral=(), improper=(), charge=None, diameter=None,
                 kspace=None, scale: bool = False, reset: bool = False, mass: bool = True):
        super().__init__(group)
        if every < 0:
            raise InputError(f"fix adapt: N must not be negative, got {every}")
        self.adapt_every, self.pair = every, [tuple(p) for p in pair]
        self.bonded = {c: [tuple(b) for b in given] for c, given in zip(BONDED, (bond, angle, dihedral, improper))}
        self.charge, self.diameter, self.kspace, self.scale, self.reset, self.mass = charge, diameter, kspace, scale, reset, mass
        if not self.pair and not any(self.bonded.values()) and charge is None and diameter is None and kspace is None:
            raise InputError("fix adapt needs at least one of pair, bond, angle, dihedral, improper, kspace, atom")
        self._kept: list[tuple] = []        # dictionaries of coefficients, or arrays, and what they had

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix adapt"
        every, left, given = whole(take(words, 1, what)[0], f"{what} N"), list(words[1:]), {}
        system = session.scene.need_system(what)
        while left and left[0] not in OPTIONS:
            key, *left = left
            if key == "pair":
                style, name, i, j, value = take(left, 5, f"{what} pair")
                for word in (i, j):
                    bounds(word, 1, system.counts["ntypes"], f"{what} pair", system.labels["atom"])
                given.setdefault("pair", []).append((style, name, i, j, cls._variable(value, session)))
                left = left[5:]
            elif key in BONDED:
                style, name, t, value = take(left, 4, f"{what} {key}")
                bounds(t, 1, system.counts[f"n{key}types"], f"{what} {key}", system.labels[key])
                given.setdefault(key, []).append((style, name, t, cls._variable(value, session)))
                left = left[4:]
            elif key == "atom":
                name, value = take(left, 2, f"{what} atom")
                if name not in ("charge", "diameter"):
                    raise InputError(f"{what} atom: {name!r} is unknown or not supported, it must be charge or diameter")
                if name == "charge" and system.q is None:
                    raise InputError(f"{what} atom charge: atom_style {system.atom_style} has no charges")
                if name == "diameter" and "radius" not in system.extra:
                    raise InputError(f"{what} atom diameter: atom_style {system.atom_style} has no radius")
                given[name] = cls._variable(value, session, atoms=True)
                left = left[2:]
            elif key == "kspace":
                given[key] = cls._variable(take(left, 1, f"{what} {key}")[0], session)
                left = left[1:]
            else:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, ('pair', *BONDED, 'atom', 'kspace', *OPTIONS))}")
        options = {k: yes_no(v[0], f"{what} {k}") for k, v in sampled.keywords(left, OPTIONS, what).items()}
        fix = cls(group, every, **given, **options)
        fix.words = list(words)
        fix._check(session.scene.interactions, True)
        return fix

    @staticmethod
    def _variable(word: str, session, atoms: bool = False) -> Formula:
        if not word.startswith("v_"):
            raise InputError(f"fix adapt: the value must be a variable v_name, got {word!r}")
        found = Formula(word[2:], session)
        if word[2:] in session.variables.table:
            _check_style(found, atoms)
        return found

    def to_lammps(self) -> list[str]:
        if not hasattr(self, "words"):
            raise InputError("fix adapt: Python functions cannot be written as a script")
        return self.words

    def _check(self, interactions, early: bool = False) -> None:
        """Refuse styles and coefficients that are not there, and variables of other styles; `early`: not what may come yet."""
        for category, given in {"pair": self.pair, **self.bonded}.items():
            for style, name, *_, value in given:
                if interactions.uses[category] or not early:
                    uses_of(interactions, category, style, name, "fix adapt")
                if not early:
                    _check_style(value)
        if not early:
            for value, atoms in ((self.charge, True), (self.diameter, True), (self.kspace, False)):
                _check_style(value, atoms)

    # ---- hooks
    def next_step(self, step: int) -> int:
        return (step // self.adapt_every + 1) * self.adapt_every if self.adapt_every else sampled.NEVER

    def setup_pre_force(self, loop) -> bool:
        """The first change."""
        self._check(loop.interactions)
        if self.kspace is not None and loop.engine.solver is None:
            raise InputError("fix adapt kspace needs a kspace_style")
        adapting = [f for f in loop.fixes if isinstance(f, Adapt)]
        if self is adapting[0]:
            for fix in adapting:        # what the run begins with, also for those after others that change the same
                fix._kept = []
                fix._remember(loop)
        self._change(loop)
        if self.charge is not None:
            choose_waves(loop.engine)
        return True

    def pre_force(self, loop) -> None:
        """Change what is due."""
        self._change(loop)

    def finish(self, loop) -> None:
        if self.kspace is not None:
            loop.interactions.kspace_factor = 1.0
        if self.reset:
            self._take_factor(loop)
            for holder, key, value in reversed(self._kept):
                _put(holder, key, value)
            self._kept = []
            self._follow_masses(loop)
            extra, seen = loop.system.extra, [loop.system.f.copy()]     # forces and torques stay those of the last step, to go on with, too
            seen += [extra["torque"].copy()] if "torque" in extra else []
            self._follow(loop)
            loop.engine.forces(True)
            rewind(loop.engine)
            loop.sync_out()
            state = loop.engine.state
            for array, of_slots, values in zip((loop.system.f, extra.get("torque")), (state.f, state.torque), seen):
                array[:], of_slots[:, loop.engine.slot_of] = values, values.T

    def _set(self, holder, key, value) -> None:
        """Set one coefficient or array, and remember what it was."""
        before = [old for h, k, old in self._kept if h is holder and k == key]
        if not before:
            before = [np.copy(holder[key]) if isinstance(holder[key], np.ndarray) else holder[key]]
            self._kept.append((holder, key, before[0]))
        new = value * before[0] if self.scale else value
        _put(holder, key, float(new) if not isinstance(before[0], np.ndarray) else new)

    def _places(self, loop):
        """Each list of the coefficients, as mappings and keys, that one value of a variable goes to, and the value's function."""
        system, counts = loop.system, loop.system.counts
        for style, name, i, j, value in self.pair:
            (ilo, ihi), (jlo, jhi) = (_range(t, counts["ntypes"], system.labels["atom"]) for t in (i, j))
            pairs, found = [(a, b) for a in range(ilo, ihi + 1) for b in range(max(a, jlo), jhi + 1)], []
            for use in uses_of(loop.interactions, "pair", style, name, "fix adapt"):
                name = spelled(use.style, name)
                for place in filter(None, (held(use, pair, name) for pair in pairs)):
                    place[0].setdefault(*place[1:])
                    found.append(place[:2])
            yield found, value
        for category, given in self.bonded.items():
            for style, name, t, value in given:
                (lo, hi), found = _range(t, counts[f"n{category}types"], system.labels[category]), []
                for use in uses_of(loop.interactions, category, style, name, "fix adapt"):
                    name = spelled(use.style, name)
                    found += [(use.coeff[k], name) for k in range(lo, hi + 1) if name in use.coeff.get(k, ())]
                yield found, value

    def _remember(self, loop) -> None:
        """What the coefficients are before this run changes them."""
        for places, _ in self._places(loop):
            for holder, key in places:
                if not any(h is holder and k == key for h, k, _ in self._kept):
                    self._kept.append((holder, key, holder[key]))

    def _change(self, loop) -> None:
        coefficients = False
        for places, value in self._places(loop):
            number = float(value(loop))
            for holder, key in places:
                self._set(holder, key, number)
                coefficients = True
        if self.charge is not None or self.diameter is not None:
            self._change_atoms(loop)
        self._follow(loop, coefficients)
        if self.kspace is not None:
            loop.interactions.kspace_factor = float(self.kspace(loop))
            self._take_factor(loop)

    @staticmethod
    def _take_factor(loop) -> None:
        """The solver takes up the present factor."""
        for term in loop.engine.terms:
            if isinstance(term, KSpaceTerm):
                term.set_factor(loop.interactions.kspace_factor)

    def _change_atoms(self, loop) -> None:
        system, mask = loop.system, loop.groups[self.group]
        own = vars(system)
        if self.charge is not None:
            self._set(own, "q", _masked(system.q, mask, self.charge(loop), self.scale))
        if self.diameter is not None:
            before = system.extra["radius"].copy()
            half = self.diameter(loop) * (1.0 if self.scale else 0.5)
            self._set(system.extra, "radius", _masked(before, mask, half, self.scale))
            if self.mass and system.rmass is not None:
                ratio = np.divide(system.extra["radius"], before, out=np.ones_like(before), where=before > 0.0)
                if not any(h is own and k == "rmass" for h, k, _ in self._kept):
                    self._kept.append((own, "rmass", system.rmass.copy()))
                system.rmass *= ratio**3
                self._follow_masses(loop)

    def _follow_masses(self, loop) -> None:
        """Those that move atoms take the masses as they are now."""
        if self.diameter is None or not self.mass:
            return
        e, s = loop.engine, loop.state
        e.mass_row[:] = loop.system.atom_masses()
        e.inverse_row[:] = e.units.ftm2v / e.mass_row
        e.varies[1] = True
        used = s.row >= 0
        s.mass[used], s.inverse_mass[used] = e.mass_row[s.row[used]], e.inverse_row[s.row[used]]

    def _follow(self, loop, coefficients: bool = True) -> None:
        """Running terms take radii, charges and, if they have changed, coefficients as they are now."""
        e = loop.engine
        if self.diameter is not None:
            coefficients |= _learn_radii(loop.interactions, loop.system)
            for t in e.terms:
                if getattr(t, "sized", False):
                    t.take_radii(e)
        if self.charge is not None:
            recharge(loop)
        if coefficients and not _in_place(e, loop.interactions, loop.system):
            retie(loop, afresh=True)
            loop._make_module()


def _check_style(value, atoms: bool = False) -> None:
    """Refuse variables whose values are no numbers; with `atoms` one for each atom serves, too."""
    if isinstance(value, Formula):
        style = value.session.variables.find(value.name).style
        if style not in ("equal", "internal", "python", *("atom",) * atoms):
            raise InputError(f"fix adapt: variable {value.name} has style {style}, it must be equal{' or atom' * atoms}")


def _learn_radii(interactions, system) -> bool:
    """Tell the pair styles that tables depend on the radii of types; whether tables may be others now. Cutoffs of smaller spheres stay."""
    changed, radii = False, largest_radii(system)
    for use in interactions.uses["pair"]:
        known = use.settings.get("radii")
        if known is not None and (not use.style.sized or any(new > old for new, old in zip(radii, known))):
            use.style.learn(use.settings, system)
            changed = True
    return changed


def _put(holder, key, value) -> None:
    """Arrays keep their place: others work on them."""
    if isinstance(value, np.ndarray):
        holder[key][:] = value
    else:
        holder[key] = value


def _masked(old: np.ndarray, mask: np.ndarray, value, factor: bool) -> np.ndarray:
    """New values of the atoms of a group, the others as they are; factors are 1 for those."""
    return np.where(mask, value, 1.0 if factor else old)


def _range(word: str, most: int, labels) -> tuple[int, int]:
    return bounds(str(word), 1, most, "fix adapt", labels)


def _in_place(e: Engine, interactions, system) -> bool:
    """Put new coefficients into the running terms; False if they need other lists or kernels."""
    if e.many_terms:
        return False
    new = [t for t in interactions.pair_terms(system.counts["ntypes"], e.units) if t.style.parts]
    for kind, *pair in e.settings.exclude:
        if kind == "type":
            for t in new:
                t.exclude(*pair)
    if len(new) != len(e.pair_terms):
        return False
    for old, fresh in zip(e.pair_terms, new):
        a, b = old.tables, fresh.tables
        same = fresh.style is old.style and a.rows.shape == b.rows.shape and np.shape(a.constants) == np.shape(b.constants)
        if not same or np.abs(a.rows[old.cut_rows] - b.rows[old.cut_rows]).max(initial=0.0) or len(a.arrays):
            return False
        if any(part.long and not part.charged for part in fresh.style.parts) and not np.array_equal(a.rows, b.rows, equal_nan=True):
            return False        # of dispersion, which a solver has a part of
        if not all(t.fits(b) for t in e.terms if getattr(t, "owner", None) is old and hasattr(t, "fits")):
            return False
    for old, fresh in zip(e.pair_terms, new):
        old.tables.rows[:] = fresh.tables.rows
        np.copyto(np.asarray(old.tables.constants), fresh.tables.constants)
        old.filled.update(fresh.filled)
        for t in e.terms:
            if getattr(t, "owner", None) is old and hasattr(t, "take_tables"):
                t.take_tables()
    for t in e.terms:
        if hasattr(getattr(t, "packed", None), "coeff"):
            fresh = t.style.pack(t.use.settings, t.use.coeff, t.packed.coeff.shape[1] - 1, e.units)
            if fresh.coeff.shape != t.packed.coeff.shape or len(fresh.arrays):
                return False
            t.packed.coeff[:] = fresh.coeff
    e.thread_arguments = None
    return True
