"""A session that notes what it executes, so that LAMMPS can be told the same without conditions, loops and includes."""
from __future__ import annotations

import copy
import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.fix.shake import Shake
from asemd.lammps.export import quoted
from asemd.lammps.session import ACTIONS, Session, Stop
from asemd.lammps.switches import Switches
from asemd.testing.lammps_side import comparable

# flow of control is resolved here; output and the shell are left out on both sides
CONTROL = frozenset("if include jump label quit".split())
LEFT_OUT = frozenset("""balance box dump dump_modify echo info log package partition plugin print processors python restart shell suffix
                     timer undump write_data write_dump write_restart""".split())
# noise that LAMMPS draws in the order its atoms are stored in
RANDOM_FIXES = frozenset("""atom/swap bd/asphere bd/sphere bond/create bond/react bond/swap brownian charge/regulation deposit dpd/energy
                         dt/reset evaporate ffl filter/corotate gcmc gjf gld gle grem hyper/local langevin langevin/drude langevin/eff
                         langevin/spin lb/fluid neb/spin phonon pimd/langevin pour qbmsst qtb rigid/meso srd temp/csld temp/csvr tfmc
                         thermal/conductivity ttm ttm/grid ttm/mod viscosity wall/srd widom""".split())


class Recorder(Session):
    """Reads a script as `asemd.read` does, but carries out its runs for a limited number of steps.

    Parameters
    ----------
    switches : Switches
        ``cap`` limits every run and minimisation; None: stop at the first one.

    Attributes
    ----------
    commands : list of str
        Commands for LAMMPS, variables replaced.
    start : int or None
        How many of them come before the first run.
    first : Scene or None
        A copy of the scene before the first run.
    rows : list of (int, int, dict)
        Number of the run, step and values by column of each thermo row.
    runs : list of str
        The run and minimize commands that were carried out, as given to LAMMPS.
    notes : list of str
        Why something was not carried out.
    documented : list of str
        Differences to LAMMPS that are meant, in what was carried out.
    failed : str
        The error that ended a run; empty if there was none.
    """

    def __init__(self, switches: Switches):
        self.rows: list[tuple[int, int, dict[str, Any]]] = []
        self.commands: list[str] = []
        self.runs: list[str] = []
        self.notes: list[str] = []
        self.documented: list[str] = []
        self.start: int | None = None
        self.first = None
        self.failed = ""
        self._acting = False
        super().__init__(switches=switches, passive=True)

    @property
    def last_thermo(self) -> dict[str, Any]:
        return self.rows[-1][2] if self.rows else {}

    @last_thermo.setter
    def last_thermo(self, row: dict[str, Any]) -> None:
        if row:
            self.rows.append((len(self.runs) - 1, self.last_thermo_step, row))

    def call(self, name: str, args: Sequence[str]) -> None:
        if name in ACTIONS and not self._acting:
            self._act(name, list(args))
            return
        if name in LEFT_OUT and name not in ("shell", "print"):
            self._check(name)
            return
        if self.runs and ((name == "velocity" and "geom" in args) or (name == "displace_atoms" and "random" in args)
                          or (name == "set" and "type/fraction" in args)):
            self._end(f"nothing is compared from {' '.join([name, *args])!r} on: its random numbers follow from the last bits of positions")
        told, noted = len(self.commands), name not in CONTROL and name not in LEFT_OUT and not self._acting
        if noted:
            self.commands.append(" ".join([name, *map(quoted, args)]))
        try:
            super().call(name, args)
        except InputError:
            if noted:
                del self.commands[told:]
            raise

    def _check(self, name: str) -> None:
        """Commands that are left out must exist all the same."""
        from asemd.lammps import catalog
        if not catalog.exists("command", name):
            raise catalog.unknown("command", name)

    def _act(self, name: str, args: list[str]) -> None:
        """A run, minimisation or rerun, capped."""
        self.scene.need_system(name)
        if self.first is None:
            from asemd.lammps.driver import check
            check(self)
            self.first, self.start = copy.deepcopy(self.scene), len(self.commands)
        if self.switches.cap is None:
            raise Stop
        if name == "rerun":
            self._end("rerun is not compared")
        noisy = sorted({f.style for f in self.scene.fixes.values()} & RANDOM_FIXES)
        if noisy and name == "run":
            args = ["0"]
        self._rebuild_in_time()
        self._make_comparable()
        if name == "minimize":
            self._compare_springs()
        words = self._capped(name, args)
        self.runs.append(" ".join([name, *map(quoted, words)]))
        self.commands.append(self.runs[-1])
        module, self._acting = importlib.import_module(f"asemd.lammps.command.{name}"), True
        try:
            module.run(self, args)
        except SimulationError as e:
            self.failed = str(e)
            raise Stop from None
        finally:
            self._acting = False
        self.scene.sync_groups()
        if noisy and name == "run":
            self._end(f"of the runs only the first step is compared: fix {', '.join(noisy)} draws random numbers in the order in which "
                      "LAMMPS stores its atoms")

    def _rebuild_in_time(self) -> None:
        """Let both programs rebuild their lists when an atom has moved half the skin.

        With lists that are too old each program misses other pairs.
        """
        n = self.scene.neighbor
        if (n.every, n.delay, n.check) != (1, 0, True):
            check = "yes" if n.check else "no"
            self.notes.append(f"neigh_modify every {n.every} delay {n.delay} check {check} is replaced by every 1 delay 0 check yes on "
                              "both sides: with lists that are too old each program misses other pairs")
            n.every, n.delay, n.check = 1, 0, True
            self.commands.append("neigh_modify every 1 delay 0 check yes")

    def _make_comparable(self) -> None:
        """Let LAMMPS compute the short range of charges and dispersion, too, unless its tables are asked for."""
        self.commands += [c for c in comparable(self.scene.interactions) if c not in self.commands[self._styled():]]

    def _compare_springs(self) -> None:
        """Say what is known of the springs that a minimisation has in place of constraints."""
        system = self.scene.system
        x = system.x.copy()
        system.box.wrap(x, system.image.copy())
        for fix in self.scene.fixes.values():
            if isinstance(fix, Shake):
                i, j = fix.held_pairs(system).T
                d = x[i] - x[j]
                across = np.abs(system.box.minimum_image(d)[0] - d).max(initial=0.0) > 1e-6 * system.box.lengths.min()
                said = ", and counts those across a periodic face twice: what follows starts from other positions" if across else ""
                self.documented.append(f"fix {fix.id} (style {fix.style}): in a minimisation LAMMPS takes half of the virial of the "
                                       f"springs that stand for constraints{said} (docs/differences.md)")

    def _styled(self) -> int:
        """Where the pair style or the solver was chosen last: new ones start with tables and without a pressure tensor."""
        return max((k for k, c in enumerate(self.commands) if c.split()[0] in ("pair_style", "kspace_style")), default=0)

    def _end(self, note: str) -> None:
        self.notes.append(note)
        raise Stop

    def _capped(self, name: str, args: list[str]) -> list[str]:
        """The words after ``run`` or ``minimize`` for LAMMPS, which has no limit on the steps of all runs."""
        cap, words = self.switches.cap, list(args)
        at = 2 if name == "minimize" else 0
        try:
            steps = int(words[at])
        except (IndexError, ValueError):
            return words        # the command itself says what is wrong
        if "upto" in words:
            words.remove("upto")
            steps -= self.scene.step
        if steps > cap:
            self.notes.append(f"{name} {' '.join(args[:at + 1])}: only {cap} steps are compared")
        words[at] = str(min(steps, cap))
        return words
