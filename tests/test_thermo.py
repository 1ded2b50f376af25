"""Thermo rows, character by character as LAMMPS (22 Jul 2025) writes them."""
from __future__ import annotations

import pytest

from asemd.errors import InputError
from asemd.thermo import Thermo

ONE = [0, 1.44, -6.7733681, 0.0, -4.6218056, -5.0244179]


def test_one():
    thermo = Thermo()
    columns = thermo.columns()
    assert thermo.header(columns) == "   Step          Temp          E_pair         E_mol          TotEng         Press     "
    assert thermo.row(columns, ONE) == "         0   1.44          -6.7733681      0             -4.6218056     -5.0244179    "


def test_custom_mixes_integers_and_numbers():
    thermo = Thermo()
    thermo.set_style("custom", "step elapsed atoms dt time temp".split())
    columns = thermo.columns()
    assert thermo.header(columns) == "   Step       Elapsed      Atoms          Dt            Time           Temp     "
    assert thermo.row(columns, [10, 0, 32, 0.005, 0.05, 1.0849398]) == (
        "        10           0          32   0.005          0.05           1.0849398    ")


def test_multi():
    thermo = Thermo()
    thermo.set_style("custom", "step press c_thermo_press[1] vol".split())
    thermo.line = "multi"
    assert thermo.row(thermo.columns(), [0, -2.97114, -3.011, 37.9057], 0, 0.0) == (
        "------------ Step              0 ----- CPU =            0 (sec) -------------\n"
        "Step     =              0 Press    =        -2.9711 c_thermo_press[1] =        -3.0110 \n"
        "Volume   =        37.9057")


def test_yaml():
    thermo = Thermo()
    thermo.set_style("custom", "step temp atoms".split())
    thermo.line = "yaml"
    columns = thermo.columns()
    assert thermo.header(columns) == "---\nkeywords: ['Step', 'Temp', 'Atoms', ]\ndata:"
    assert thermo.row(columns, [5, 1.3688330270177, 32]) == "  - [5, 1.3688330270177, 32, ]"
    assert thermo.footer() == "..."


def test_formats():
    thermo = Thermo()
    thermo.set_style("custom", ["step", "temp", "press"])
    thermo.format_column[2], thermo.format_kind["int"], thermo.format_word["press"] = "%20.3f", "%6ld", "%g"
    assert thermo.row(thermo.columns(), [10, -0.40438, 0.5]) == "    10               -0.404 0.5"
    thermo.format_line = ("%d", "%g", "%g")
    assert thermo.row(thermo.columns(), [0, 1.44, -5.504661]) == "     0                1.440 -5.50466"


def test_names():
    thermo = Thermo()
    thermo.names = {2: "TT", "press": "P"}
    assert thermo.header(["step", "temp", "press"]).split() == ["Step", "TT", "P"]


def test_volume_follows_a_changing_box():
    thermo = Thermo()
    assert thermo.columns(box_changes=True)[-1] == "vol"
    thermo.set_style("custom", ["step"])
    assert thermo.columns(box_changes=True) == ["step"]


def test_unknown_keyword():
    with pytest.raises(InputError, match="'tmp'.*did you mean temp"):
        Thermo().set_style("custom", ["step", "tmp"])


def test_a_new_style_forgets_what_was_modified():
    thermo = Thermo(every=10, norm=False, lost="ignore")
    thermo.set_style("one", [])
    assert (thermo.every, thermo.norm, thermo.lost) == (10, None, "error")


def test_kinetic_tensor_is_per_atom_where_energies_are():
    from both import asemd
    session = asemd("""
    lattice fcc 0.8442
    region b block 0 2 0 2 0 2
    create_box 1 b
    create_atoms 1 box
    mass 1 1
    pair_style lj/cut 1.5
    pair_coeff 1 1 1 1
    velocity all create 1.0 123
    thermo_style custom step ke c_thermo_temp[1] c_thermo_temp[2] c_thermo_temp[3] c_thermo_temp
    run 0
    """)
    step, ke, *tensor, temperature = session.last_thermo.values()
    assert sum(tensor) == pytest.approx(2.0 * ke) and temperature == pytest.approx(1.0)


def test_columns_of_vectors_that_are_not_known_yet(tmp_path):
    """``[*]`` before the first run: how many elements there are is known without their values."""
    from asemd.lammps import Lammps
    lmp = Lammps(cmdargs=["-screen", "none", "-log", str(tmp_path / "log")])
    lmp.commands_string("""units lj
region box block 0 4 0 4 0 4
create_box 1 box
create_atoms 1 single 1 1 1
create_atoms 1 single 2 1 1
mass 1 1.0
pair_style lj/cut 1.9
pair_coeff 1 1 1.0 1.0
compute s all stress/atom NULL
compute sum all reduce sum c_s[*]
compute some all slice 1 5 2 c_thermo_press
compute n all count/type atom
compute h all voronoi/atom edge_histo 1
thermo_style custom step c_sum[*] c_some[*] c_n[*] c_h[*]
fix 1 all nve
run 0""")
    header = next(line for line in (tmp_path / "log").read_text().splitlines() if line.split()[:1] == ["Step"])
    assert header.split() == ["Step", *(f"c_sum[{k}]" for k in range(1, 7)), "c_some[1]", "c_some[2]", "c_n[1]", "c_h[1]", "c_h[2]"]
