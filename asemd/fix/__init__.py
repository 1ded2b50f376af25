r"""Fixes are dynamics. One fix, one file; a fix is a plain class with keyword arguments, usable from Python and from a script.

A fix acts through hooks with LAMMPS's names and order. A hook is either *compiled* (a plain function marked `hook`, called by the
compiled time loop) or a Python method of the same name that takes the live `asemd.loop.Loop`. With compiled hooks only, whole stretches
of steps run without Python.

A compiled hook has the signature ``f(th, s, p, a)``:

- ``th`` (`asemd.kernels.state.Thread`): ``tid, nth, lo, hi`` (this thread's slots are ``lo..hi-1``), ``step`` (this timestep),
  ``begin, end`` (first and last step of the run or of ``run start/stop``, for ramps), ``dt``, ``sync``, ``scratch``;
- ``s`` (`asemd.kernels.state.State`): slot arrays ``x v f (3, cap)``, ``mass inverse_mass q (cap,)`` (inverse_mass is ftm2v / m; 0 for
  empty slots), ``type mask row (cap,)`` (mask: group bits; row: index of the atom, -1 for an empty slot, whose mask is 0);
  ``torque (3, cap)`` beside ``f``, zero before the forces of each step, where atoms turn or have dipoles, else ``(0, cap)``;
- ``p (k,) float64``: the fix's own numbers, made by `parameters`, shared by all threads and kept between steps (``p[0]`` is the group
  bit as a float);
- ``a (m, n) float64``: the fix's own per-atom numbers by row, made by `atom_arrays` (a (1, 1) dummy if it has none).

Loops over slices of this thread (``s.v[d, th.lo:th.hi]``, index from 0) become vector instructions, ``range(th.lo, th.hi)`` does not:
the compiler must know that an index is not negative.

Sums over all atoms: ``reduce_sum(th, value)`` from `asemd.kernels.threads` gives every thread the total. Write to ``p`` from thread 0
only, with ``barrier(th)`` around it. Uniform noise: ``uniform(seed, step, row, k)`` from `asemd.kernels.random`. A function of one's own
that several hooks share is named with ``@hook(uses=[function])``; if it has the attribute ``strict``, its sums and
products keep their order to the last bit.

A fix may offer ``final_initial`` besides: `final_integrate` of a step and `initial_integrate` of the next in one pass, used where nothing
happens in between.

The array that `parameters` returns is the one the hooks work on, so a fix that keeps it sees its numbers live; likewise `atom_arrays`.

``asemd.fix.NVT`` is the class in ``asemd/fix/nvt.py``, imported when asked for; `find` goes by the LAMMPS name.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from asemd.errors import InputError
from asemd.registry import class_called, class_of, remember
from asemd.words import whole, yes_no

if TYPE_CHECKING:
    from asemd.loop import Loop

NEVER = 2**62       # a step that does not come
HOOKS = ("initial_integrate", "post_integrate", "pre_exchange", "pre_neighbor", "post_neighbor", "pre_force", "post_force",
         "final_integrate", "end_of_step")


def hook(function: Callable | None = None, *, uses: Sequence[Callable] = ()):
    """Mark a plain function as a compiled hook; `uses` are the functions it calls beside those of `asemd.kernels`."""
    if function is None:
        return lambda f: hook(f, uses=uses)
    function.compiled, function.uses = True, tuple(uses)
    return staticmethod(function)


class Fix:
    """Base class of fixes.

    Parameters
    ----------
    group : str
        Name of the group it acts on.

    Attributes
    ----------
    style : str
        LAMMPS name, set by each class.
    integrates : bool
        True if it moves atoms (two of these on one atom are warned about).
    needs_atoms : bool
        True if a run must not begin with a group that is empty.
    observes : bool
        True if it changes nothing of the system.
    minimizes : bool
        True if its post_force acts during minimisation too.
    ecouple : bool
        True if `scalar` is the energy of a heat bath, counted by the thermo keywords ecouple and econserve.
    every : int
        `end_of_step` is called on multiples of this.
    levels : str
        Where `post_force` acts under ``run_style respa``: on ``every`` level, the ``outermost`` one, or ``one``, which is the outermost
        unless `level` (``fix_modify respa``) says another, from 1. Empty: it does not work there, unless `end_of_step` is all it has.
        Other hooks: `post_integrate` follows each move of the atoms, `pre_force` comes once in a step.
    inner : type
        The class whose hooks move the atoms on all levels but the outermost, if not its own; ``outer_initial`` is a hook that takes the
        place of `initial_integrate` on the outermost of several levels and moves no atom (by default `final_integrate`), ``inner_final``
        one in the place of `final_integrate` on the innermost, ``middle`` one for both halves of steps of those between.
    thermo_energy, thermo_virial : bool
        ``fix_modify energy yes``, ``fix_modify virial yes``: `scalar` counts as potential energy, what hooks
        add to ``s.virial`` as virial (they add it only then), ``virials(state)`` in virials by atom.
    box_moves : str
        ``size`` or ``shape`` for a fix that changes the box during a run (shape: it may become tilted).
    virial_every : int
        Compiled hooks see the virial of the terms (``s.acc``) on multiples of this step; 0: never.
    with_energies : bool
        And their energies.
    next_reneighbor : int
        The step on which it asks for a list build, with its hook `pre_exchange` before it.
    follows : str
        The compiled hook before which `follow` is called, in Python, for numbers that change from step to step. Empty: none does.
    output_needs : set of str
        What must be known of a step on which its outputs are asked for, as in `needs`.
    needs : set of str
        What its Python hooks want to see of the steps on which they act: ``energy``, ``virial``, ``energies``, ``virials``.
    restarts : tuple of str
        How the log names what a restart file holds of it: ``global``, ``peratom``, which is also said of a fix without `state`.
    minimizing : bool
        Set while a minimisation goes on.
    brings : tuple of str
        Its attributes that are computes, which a script reaches as ``ID_name`` (see `own_computes`) while the fix is there.
    id : str
        Set by the session.
    awaited : tuple of str
        Names of the variables that it goes by, which are looked up when a run begins; set by the session.
    """

    style: ClassVar[str] = ""
    integrates: ClassVar[bool] = False
    needs_atoms: ClassVar[bool] = False
    minimizes: ClassVar[bool] = False
    observes: ClassVar[bool] = False
    ecouple: ClassVar[bool] = False
    restarts: ClassVar[tuple[str, ...]] = ("global",)
    levels: ClassVar[str] = ""
    brings: ClassVar[tuple[str, ...]] = ()
    box_moves: str = ""
    virial_every: int = 0
    with_energies: bool = False
    next_reneighbor: int = -1
    follows: str = ""
    output_needs: frozenset[str] = frozenset()
    needs: frozenset[str] = frozenset()
    level: int = 0
    inner: ClassVar[type | None] = None
    every: int = 1
    id: str = ""
    awaited: tuple[str, ...] = ()
    thermo_energy: bool = False
    thermo_virial: bool = False
    minimizing: bool = False

    def __init_subclass__(cls, **keywords):
        super().__init_subclass__(**keywords)
        remember("fix", cls)

    def __init__(self, group: str = "all"):
        self.group = group

    def __getstate__(self):
        return {**self.__dict__, "_loop": None} if "_loop" in self.__dict__ else self.__dict__      # it holds compiled code

    @classmethod
    def from_lammps(cls, group: str, words: list[str], session) -> Fix:
        """Build from the words after the style's name in ``fix ID group style words...``."""
        if words:
            raise InputError(f"fix {cls.style} takes no arguments, got {' '.join(words)}")
        return cls(group=group)

    def to_lammps(self) -> list[str]:
        """Words after the style's name that make this fix again."""
        return []

    def hooks(self) -> dict[str, bool]:
        """Hooks this instance has now -> whether each is compiled. Override where it depends on the arguments."""
        return {name: bool(getattr(getattr(self, name), "compiled", False)) for name in HOOKS if getattr(self, name, None)}

    def own_computes(self) -> dict[str, Any]:
        """The computes that it brings, by their IDs."""
        return {f"{self.id}_{name}": getattr(self, name) for name in self.brings}

    def prepare(self, loop: Loop) -> None:
        """Called at the start of every run, before its first list."""

    def join(self, loop: Loop) -> None:
        """Called when a loop is made, before its terms: what a fix changes in ``loop.system`` for them, it changes here."""

    def detach(self, system) -> None:
        """Called when the fix is taken away: what it has changed in the system is undone."""

    def parameters(self, loop: Loop) -> np.ndarray:
        """The numbers ``p`` of the compiled hooks; called at the start of every run. ``p[0]`` is the group bit."""
        return np.array([float(loop.group_bit(self.group))])

    def atom_arrays(self, loop: Loop) -> np.ndarray | tuple[np.ndarray, ...] | None:
        """Per-atom numbers ``a (m, n)`` by atom row, or None; or several arrays of others, such as ``system.extra``, as a tuple."""
        return None

    def next_step(self, step: int) -> int:
        """The next step after `step` within which hooks in Python act. The steps between are compiled."""
        return step + 1

    def next_end(self, step: int) -> int:
        """The next step after `step` at whose end `end_of_step`, in Python, acts."""
        return (step // self.every + 1) * self.every

    def next_list(self, step: int) -> int:
        """The next step after `step` on which hooks around a list build act, besides those on which the fix asks for one; until then the
        compiled loop may build lists by itself."""
        return step + 1

    def follow(self, loop: Loop) -> None:
        """Put the present numbers into ``p`` and ``a``; called before the compiled hook that `follows` names."""

    def setup_pre_force(self, loop: Loop) -> bool:
        """Called at the start of every run, before any `setup`: whether it has changed what the first forces come from."""
        return False

    def setup(self, loop: Loop) -> None:
        """Called at the start of every run, after the first forces; compiled post_force hooks are applied to those forces by the loop."""

    def resize(self, loop: Loop) -> None:
        """Called when atoms have left or joined the system during a run, after `atom_arrays`, or a dynamic group has other members; numbers
        in ``p`` that depend on them are set here."""

    def broken_constraint(self, loop: Loop) -> str:
        """What a constraint of this fix does not keep any more, with atom ids and numbers: a run stops with it. Empty: all is well."""
        return ""

    def finish(self, loop: Loop) -> None:
        """Called after every run; read results back from ``p`` here."""

    # outputs: f_ID, f_ID[i]
    def scalar(self) -> float:
        raise InputError(f"fix {self.id} (style {self.style}) has no global scalar")

    def vector(self, i: int) -> float:
        """Component `i`, counted from 1."""
        raise InputError(f"fix {self.id} (style {self.style}) has no global vector")

    def virials(self, state) -> np.ndarray:
        """(n, 6) each atom's share of what this fix adds to the virial: xx yy zz xy xz yz, energy units."""
        raise InputError(f"fix {self.id} (style {self.style}) has no virial by atom: say fix_modify {self.id} virial no, or name the terms "
                         "of compute stress/atom without fix")

    def local_columns(self) -> int | None:
        """Columns of ``local(state)``, f_ID[i]: 0 for a vector, None for a fix without local values."""
        return None

    def modify(self, words: list[str], session) -> None:
        """``fix_modify`` words: pairs of keyword and value."""
        if len(words) % 2 or not words:
            raise InputError(f"fix_modify: needs pairs of keyword and value, got {' '.join(words) or 'nothing'}")
        for keyword, value in zip(words[::2], words[1::2], strict=True):
            if keyword == "dynamic/dof":        # every fix takes it; atoms that a fix holds are counted anew at each run
                yes_no(value, "fix_modify dynamic/dof")
            elif not self.modify_option(keyword, value, session):
                raise InputError(f"fix_modify: fix {self.id} (style {self.style}) does not support {keyword} {value}")

    def modify_option(self, keyword: str, value: str, session) -> bool:
        """Take one pair of ``fix_modify`` words; False if this style has no such option."""
        if keyword == "respa" and self.levels == "one":
            self.level = whole(value, "fix_modify respa")
            if self.level < 0:
                raise InputError(f"fix_modify respa: a level is a number from 1 on, got {value}")
            return True
        return keyword in ("energy", "virial") and value in ("no", "off", "false")

    def removed_dof(self, mask: np.ndarray) -> float:
        """Degrees of freedom this fix removes from the atoms of `mask`."""
        return 0.0

    def added_dof(self, mask: np.ndarray) -> float:
        """Those of them that it did not yet remove when the run began: of molecules that came since."""
        return 0.0

    def state(self) -> dict[str, Any]:
        """What a restart file needs so that this fix goes on: numbers, words and arrays by name, nothing for a fix without memory.

        What hooks keep in ``p`` and ``a`` between the steps of a run is kept without it; this is what outlives a run.
        """
        return {}

    def restore(self, state: dict[str, Any]) -> None:
        """Take up what `state` of a fix of this ID and style returned; called when the fix was just made.

        Raises
        ------
        InputError
            By fixes that return something from `state` and do not override this.
        """
        if state:
            raise InputError(f"fix {self.id} (style {self.style}) cannot go on from a restart file")

    def goes_on(self, words: list[str], numbers: list[np.ndarray]) -> bool:
        """Whether this fix is the one that had these `words` and, in the midst of a run, these `numbers` ``a`` when they were kept."""
        return [str(w) for w in self.to_lammps()] == words

    def write_beside(self, path: str, system, step: int) -> None:
        """Write files of its own beside the restart file `path`."""


def find(name: str) -> type[Fix]:
    """The class of a LAMMPS fix style; raises `InputError` with the nearest match."""
    return class_of("fix", name, Fix)


def __getattr__(name: str) -> type[Fix]:
    return class_called("fix", name, Fix)
