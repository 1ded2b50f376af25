"""A script as it stands before its first run, in other forms: a plain LAMMPS script with a data file, a Python script, ASE's files."""
from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path

from asemd import units as unit_styles
from asemd import user_styles
from asemd.errors import InputError, InputWarning
from asemd.fix.shake import Shake
from asemd.lammps import catalog, export, live_coefficients
from asemd.lammps.carried import carried
from asemd.lammps.data_write import write_data
from asemd.lammps.session import ACTIONS, Session, Stop
from asemd.lammps.switches import Switches
from asemd.scene import Scene
from asemd.system import System

FORMS = ("lammps", "python", "ase", "data")
# commands that hold until they are changed and are neither atoms nor interactions: kept as they were given, variables replaced
KEPT = frozenset("""fix fix_modify unfix compute compute_modify uncompute variable region lattice thermo thermo_style thermo_modify timestep
                    run_style min_style min_modify molecule dump dump_modify undump restart""".split())
# those of them that fixes need
MAKERS = frozenset("fix fix_modify unfix compute compute_modify uncompute variable region lattice molecule timestep".split())
# fixes after which there are other atoms, types or bonds
CHANGING = frozenset("append/atoms atom/swap bond/break bond/create bond/swap deposit evaporate gcmc".split())


class Reader(Session):
    """Reads a script up to its first run and notes the commands of `KEPT`.

    Attributes
    ----------
    kept : list of str
    action : str
        The run or minimize command that was reached; empty if the script has none.
    """

    def __init__(self, switches: Switches | None = None):
        self.kept: list[str] = []
        self.action = ""
        super().__init__(switches=switches, passive=True)

    def call(self, name, args):
        if name in ACTIONS:
            self.action = " ".join([name, *map(export.quoted, args)])
        super().call(name, args)
        if name in KEPT:
            self.kept.append(" ".join([name, *map(export.quoted, args)]))


def read(path: str | os.PathLike, switches: Switches | None = None) -> Reader:
    """The script, executed up to its first run.

    Raises
    ------
    InputError
        It has a mistake, or defines no atoms.
    """
    session = Reader(switches)
    try:
        session.file(path)
    except Stop:
        session.label = None
    session.scene.need_system("convert")
    return session


def to_lammps(scene: Scene, folder: str | os.PathLike, name: str = "scene", more: list[str] | None = None,
              early: Sequence[str] = ()) -> Path:
    """Write a scene as ``in.NAME`` and ``data.NAME``; the script reads the data file from the working directory.

    Files that the commands read, as those of potentials and tables, are copied beside them.

    Parameters
    ----------
    scene : Scene
    folder : path
        Made if it does not exist.
    name : str
    more : list of str, optional
        Commands after the force field instead of the scene's own timestep and fixes.
    early : sequence of str, optional
        Commands between the data file and the coefficients.

    Returns
    -------
    Path
        The script.

    Raises
    ------
    InputError
        What a data file cannot hold; fixes whose arguments name regions, computes or variables; a folder that cannot be written.
    """
    if more is None or more:
        _of_lammps(scene)
        return _write(scene, released(scene), folder, name, _fixes(scene) if more is None else more, early)
    return _write(scene, scene.need_system("to_lammps"), folder, name, [])


def _write(scene: Scene, system: System, folder: str | os.PathLike, name: str, more: list[str], early: Sequence[str] = ()) -> Path:
    """The script and its data file, which holds this system."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lines = export.commands(system, scene.interactions, scene.settings(), folder / f"data.{name}")
        first = next(k for k, line in enumerate(lines) if line.startswith("read_data "))
        lines[first:first + 1] = [f"read_data data.{name}", *early]
        if scene.newton != (True, True):
            lines.insert(1, "newton " + " ".join("on" if on else "off" for on in scene.newton))
        path = folder / f"in.{name}"
        lines = carried([*lines, *_scene_lines(scene), *more], folder, (path.name, f"data.{name}"))
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as e:
        raise InputError(f"cannot write {folder}: {e.strerror or e}") from None
    return path


def released(scene: Scene) -> System:
    """A copy of the system in which bonds and angles are on that fixes hold: where these fixes are made, they turn them off again."""
    system = scene.need_system("to_lammps").copy()
    for fix in scene.fixes.values():
        if isinstance(fix, Shake):
            fix.detach(system)
    return system


def held(scene: Scene) -> list[str]:
    """Commands for a scene written with nothing after the force field: bonds and angles that fixes hold are turned on, and held by them."""
    fixes = [fix for fix in scene.fixes.values() if isinstance(fix, Shake)]
    on = export.turned_off(scene.need_system("to_lammps"), undo=True) if fixes else []
    return [*on, *(" ".join(["fix", fix.id, fix.group, fix.style, *fix.to_lammps()]) for fix in fixes)]


def _scene_lines(scene: Scene) -> list[str]:
    """Neighbour settings, groups and the step."""
    n, ids = scene.neighbor, scene.system.id
    out = [f"neigh_modify every {n.every} delay {n.delay} check {'yes' if n.check else 'no'}"]
    for name, mask in scene.groups.items():
        if name != "all":
            out.append(f"group {name} id {export.id_ranges(ids[mask])}" if mask.any() else f"group {name} empty")
    return [*out, *([f"reset_timestep {scene.step}"] if scene.step else [])]


def _of_lammps(scene: Scene) -> None:
    """Refuse fixes that LAMMPS does not have."""
    for fix in scene.fixes.values():
        if not catalog.is_of_lammps("fix", fix.style):
            raise InputError(f"to_lammps: fix {fix.id} (style {fix.style}) is asemd's own, LAMMPS does not have it: take another fix for a "
                             "script that LAMMPS has to run")
        if getattr(fix, "settle", False) is True:
            raise InputError(f"to_lammps: keyword settle of fix {fix.id} (style {fix.style}) is asemd's own: leave it out for a script "
                             "that LAMMPS has to run")


def _fixes(scene: Scene) -> list[str]:
    if names := [use.scale for use in scene.interactions.uses["pair"] if isinstance(use.scale, str)]:
        raise InputError(f"to_lammps: pair_style hybrid/scaled uses {names[0]}, which only a script can give it: "
                         "asemd convert in.file --to lammps keeps it")
    out = [f"timestep {scene.dt!r}"]
    for fix in scene.fixes.values():
        words = [str(w) for w in fix.to_lammps()]
        for word in words:
            if word[:2] in ("v_", "c_", "f_") or word == "region":
                raise InputError(f"to_lammps: fix {fix.id} (style {fix.style}) uses {word}, which only a script can give it: "
                                 "asemd convert in.file --to lammps keeps it")
        out.append(" ".join(["fix", fix.id, fix.group, fix.style, *map(export.quoted, words)]))
    return out


def to_python(session: Reader, folder: str | os.PathLike, name: str) -> Path:
    """Write ``NAME.py``, which runs the scene under ASE, beside ``in.NAME_atoms`` and ``data.NAME_atoms`` with the force field.

    The fixes are made by their commands, as they stand in the script.

    Returns
    -------
    Path
        The Python script.

    Raises
    ------
    InputError
        As `to_lammps`; fixes after which there are other atoms or bonds, ``run_style respa``.
    """
    scene = session.scene
    integrates = any(f.integrates for f in scene.fixes.values())
    if integrates:
        _under_ase(scene)
    _write(scene, released(scene) if integrates else scene.system, folder, f"{name}_atoms", [])
    words = session.action.split()
    steps = int(words[1]) if words[:1] == ["run"] and words[1].isdigit() else 0
    lines = [f'"""{scene.system.n} atoms under ASE, written by asemd."""', "import os", "import sys", "", "import asemd",
             "from asemd.errors import in_one_line",
             *(["from asemd.user_styles import import_file"] if user_styles.files else []), "",
             *(f"import_file({path!r})" for path in user_styles.files),
             "sys.excepthook = in_one_line", "os.chdir(os.path.dirname(os.path.abspath(__file__)))"]
    energy = 'print("potential energy", atoms.get_potential_energy())'
    if any(use.style.stirred for use in scene.interactions.uses["pair"]):       # their energies take a run
        energy = 'print(len(atoms), "atoms")'
    if not integrates:
        return _written(Path(folder) / f"{name}.py", [*lines, f'atoms = asemd.read("in.{name}_atoms")', energy])
    commands = carried([line for line in session.kept if line.split()[0] in MAKERS], Path(folder), (f"in.{name}_atoms", f"{name}.py"))
    silent = '' if any(f.style == "print" for f in scene.fixes.values()) else '"-screen", "none", '
    lines += [f'session = asemd.Lammps(cmdargs=[{silent}"-log", "none"])', f'session.file("in.{name}_atoms")',
              "atoms = session.scene.to_atoms()", energy, "", "session.commands_list([", *(f"    {c!r}," for c in commands), "])",
              f"dynamics = asemd.MolecularDynamics(atoms, timestep={scene.dt * unit_styles.factor('time', scene.units)!r},",
              "                                   fixes=session.scene.fixes.values(), groups=session.scene.groups)",
              f"dynamics.run({steps})", 'print("potential energy", atoms.get_potential_energy(), "temperature", atoms.get_temperature())']
    return _written(Path(folder) / f"{name}.py", lines)


def _under_ase(scene: Scene) -> None:
    """Refuse what `asemd.MolecularDynamics` cannot do."""
    if scene.respa is not None:
        raise InputError("convert: run_style respa has no form under ASE, whose dynamics have one timestep: leave it out and take the "
                         "timestep of its innermost level, or convert --to lammps")
    for fix in scene.fixes.values():
        if fix.style in CHANGING:
            raise InputError(f"convert: after fix {fix.id} (style {fix.style}) there may be other atoms, types or bonds, which dynamics "
                             "under ASE do not follow: leave the fix out, or convert --to lammps")


def _written(path: Path, lines: list[str]) -> Path:
    try:
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as e:
        raise InputError(f"cannot write {path}: {e.strerror or e}") from None
    return path


def to_ase(scene: Scene, path: str | os.PathLike) -> Path:
    """Write atoms with energy and forces in a format of ASE, by the ending of the file's name; the force field stays behind,
    bonds too in formats that do not keep ``atoms.info``. Forces with friction and noise, which take a run, are left out.

    Raises
    ------
    InputError
        ASE does not know the format, or the file cannot be written.
    """
    import ase.io
    from ase.io.formats import UnknownFileTypeError, filetype
    path = Path(path)
    if not path.suffix:
        raise InputError(f"convert: {path.name} has no ending that says the format: use a name such as {path.name}.extxyz, .json or .traj")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputWarning)       # what is not part of the calculator does not go into the file anyway
        atoms = scene.to_atoms()
    if any(use.style.stirred for use in scene.interactions.uses["pair"]):
        atoms.calc = None
    else:
        atoms.get_forces()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        name = path.name.replace("in.", "x.", 1) if path.name.startswith("in.") else path.name       # the names in.* are those of scripts
        ase.io.write(path, atoms, format=filetype(name, read=False))
    except UnknownFileTypeError:
        raise InputError(f"convert: ASE knows no format for {path.name}: use a name such as {path.stem}.extxyz, .json or .traj") from None
    except OSError as e:
        raise InputError(f"cannot write {path}: {e.strerror or e}") from None
    return path


def convert(source: str | os.PathLike, form: str, output: str | os.PathLike | None = None, switches: Switches | None = None) -> Path:
    """Write a script in another form; returns what was written.

    Parameters
    ----------
    source : path
        A LAMMPS script, executed up to its first run.
    form : str
        ``lammps``, ``python``, ``ase`` or ``data``.
    output : path, optional
        Folder (lammps, python) or file (ase, data; in a folder that exists ``NAME.extxyz``, ``NAME.data``). By default in ``converted``, so
        that no input is overwritten.
    switches : Switches, optional
    """
    session = read(source, switches)
    scene, base = session.scene, os.path.basename(os.fspath(source))
    name = base[3:] if base.startswith("in.") and len(base) > 3 else Path(base).stem
    output = Path(output or "converted")
    if form == "lammps":
        known = live_coefficients.defined(session)
        early = [line for line in session.kept if line.split()[0] == "variable" and line.split()[1] in known]
        more = [line for line in session.kept if line not in early]
        return to_lammps(scene, output, name, [*more, *([session.action] if session.action else [])], early)
    changing = [] if form == "data" else live_coefficients.freeze(session)
    if form == "python" and changing:
        raise InputError(f"convert: variable {changing[0]} of the force field changes during the run, which dynamics under ASE do not "
                         "follow: take a number in its place, or convert --to lammps")
    if form == "python":
        return to_python(session, output, name.replace(".", "_"))
    path = output / f"{name}.{'extxyz' if form == 'ase' else 'data'}" if output.is_dir() or output == Path("converted") else output
    if form == "ase":
        return to_ase(scene, path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as e:
        raise InputError(f"cannot write {path}: {e.strerror or e}") from None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InputWarning)
        unlike = any(line[0] != line[1] for line in scene.interactions.coeff_lines("pair"))
        write_data(path, scene.system, scene.interactions, pair="ij" if unlike else "ii")
    for warning in caught:
        warnings.warn(str(warning.message), InputWarning, stacklevel=2)
    return path
