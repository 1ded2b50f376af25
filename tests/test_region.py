"""Regions: membership of points, sides, lattice units, mistakes."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, assert_same, lammps
from wheel import ran

from asemd.errors import AsemdError, InputError
from asemd.fix.wall_region import colloid
from asemd.region.block import Block
from asemd.region.cone import Cone
from asemd.region.cylinder import Cylinder
from asemd.region.intersect import Intersect
from asemd.region.plane import Plane
from asemd.region.prism import Prism
from asemd.region.sphere import Sphere
from asemd.region.union import Union

BOX = """
units metal
lattice fcc 3.52 orient x 1 1 0 orient y -1 1 0 orient z 0 0 1
region b block 0 4 0 4 0 4
create_box 2 b
region s sphere 2 2 2 1.6
region c cylinder x 2 2 0.7 0.5 3
region o cylinder z 7 7 5 INF INF side out units box
region u union 2 s c
region i intersect 2 s c side out
region k cone z 2 2 0.2 1.5 1 3
region q prism 0.5 2 0.6 3 0.3 2 0.3 0.2 0.1
region h plane 2 2 2 1 1 0.3 side out
region e block 1 EDGE INF 2 0 1.5 units box
region n intersect 2 u e
variable a equal 1.3
variable t equal 0.5
region v sphere v_a 2 v_a v_a
region m block 0 2 v_t 2 0 v_a move v_a NULL v_t
region r block 0 2 0 2 0 2 units box rotate v_t 1 1 1 1 2 1 move v_a v_a NULL side out
region l ellipsoid 2 2 2 v_a v_t 2
region w union 2 m l
"""
MOVES = """
variable d equal step*0.01
region g block 0 2.8 INF INF INF INF units box move v_d NULL NULL
"""


@pytest.fixture(scope="module")
def theirs():
    return lammps({r: BOX + f"create_atoms 1 region {r}" for r in "bscouikqhenvmrlw"})


@pytest.mark.parametrize("region", "bscouikqhenvmrlw")
def test_same_lattice_points_as_lammps(theirs, region):
    assert_same(asemd(BOX + f"create_atoms 1 region {region}"), theirs[region])


POINTS = np.random.default_rng(5).uniform(-1, 5, (400, 3))


@pytest.mark.parametrize("region, rule", [
    (Block((0, 0, 0), (1, 2, 3)), lambda x, y, z: 0 <= x <= 1 and 0 <= y <= 2 and 0 <= z <= 3),
    (Sphere((1, 1, 1), 2), lambda x, y, z: (x - 1)**2 + (y - 1)**2 + (z - 1)**2 <= 4),
    (Cylinder(1, (1, 2), 1.5, 0, 3), lambda x, y, z: (x - 1)**2 + (z - 2)**2 <= 1.5**2 and 0 <= y <= 3),
    (Cone(0, (1, 1), 0, 2, 0, 4), lambda x, y, z: (y - 1)**2 + (z - 1)**2 <= (x / 2)**2 and 0 <= x <= 4),
    (Plane((0, 0, 1), (0, 0, 5)), lambda x, y, z: z >= 1),
    (Prism((0, 0, 0), (2, 2, 2), (1, 0, 0)), lambda x, y, z: 0 <= y <= 2 and 0 <= z <= 2 and 0 <= x - y / 2 <= 2),
])
def test_inside_and_outside(region, rule):
    expected = [rule(*p) for p in POINTS]
    assert region.inside(POINTS).tolist() == expected
    region.side = "out"
    assert (~region.inside(POINTS)).tolist() == expected


def test_boundary_belongs_to_the_inside():
    on = np.array([[1.0, 0.0, 0.0]])
    assert Sphere((0, 0, 0), 1).inside(on)[0] and not Sphere((0, 0, 0), 1, side="out").inside(on)[0]


def test_union_and_intersection_with_sides():
    a, b = Block((0, 0, 0), (2, 2, 2)), Sphere((2, 2, 2), 1, side="out")
    inside_a, inside_b = a.inside(POINTS), b.inside(POINTS)
    assert (Union([a, b]).inside(POINTS) == (inside_a | inside_b)).all()
    assert (Intersect([a, b]).inside(POINTS) == (inside_a & inside_b)).all()
    assert (Intersect([a, b], side="out").inside(POINTS) == ~(inside_a & inside_b)).all()
    assert Union([a, b]).extent() is None and np.array_equal(Intersect([a, b]).extent()[1], [2, 2, 2])


def test_a_moving_region_is_another_one_on_another_step():
    session = asemd(BOX + MOVES + "create_atoms 1 region b")
    counts = []
    for step in (0, 80, 160):
        session.execute(f"reset_timestep {step}")
        counts.append(session.variables.evaluate("count(all,g)"))
    x = session.scene.system.x[:, 0]

    assert counts == [float(((x >= d) & (x <= d + 2.8)).sum()) for d in (0.0, 0.8, 1.6)]
    assert session.scene.regions["g"].extent() is None and session.scene.regions["w"].varies


def test_open_faces_make_every_point_belong():
    session = asemd("region o block 0 1 0 1 0 1 units box open 1")
    assert session.scene.regions["o"].inside(POINTS).all()


@pytest.mark.parametrize("words, message", [
    ("r blok 0 1 0 1 0 1", "did you mean block"), ("r block 0 1 0 1 0", "6 values"), ("r block 1 0 0 1 0 1", "above"),
    ("r block 0 1 0 1 0 x", "number"), ("r block INF 1 0 1 0 1", "not defined yet"), ("r sphere 0 0 0 -1", "negative"),
    ("r sphere 0 0 0 v_r", "undefined variable r"), ("r cylinder w 0 0 1 0 1", "expected one of x y z"), ("r plane 0 0 0 0 0 0", "normal"),
    ("r union 2 a b", "unknown region"), ("r union 1 a", "two"), ("r block 0 1 0 1 0 1 move v_a NULL NULL", "undefined variable a"),
    ("r block 0 1 0 1 0 1 open 7", "1 to 6"), ("r block 0 1 0 1 0 1 side up", "in out"),
    ("r block 0 1 0 1 0 1 foo 1", "unknown keyword"), ("r delete", "no such region"),
])
def test_mistakes(words, message):
    with pytest.raises(InputError, match=message):
        asemd(f"lattice none 1.0\nregion {words}")


def test_defined_twice_and_deleted():
    session = asemd("region r block 0 1 0 1 0 1\nregion r delete\nregion r sphere 0 0 0 1")
    with pytest.raises(InputError, match="defined already"):
        session.execute("region r block 0 1 0 1 0 1")


SURFACES = ["block 2 9 -5 5 1 6", "sphere 5 5 5 3", "cylinder x 5 5 3 2 8", "cone y 5 5 1 4 2 8", "cone z 5 5 4 0 2 8",
            "plane 5 5 5 1 2 -1", "prism 2 8 3 9 1 7 1 -2 0.5", "block 3 7 2 8 3 6 move v_a NULL NULL rotate v_a 5 5 5 1 2 3"]


@pytest.mark.parametrize("side", ["in", "out"])
@pytest.mark.parametrize("words", SURFACES)
def test_surface(words, side):
    lmp = ran(["region all block 0 10 0 10 0 10", "create_box 1 all", "variable a equal 0.7", f"region r {words} side {side} units box"])
    region, cutoff, h = lmp.session.scene.regions["r"], 1.5, 1e-6
    x = np.random.default_rng(2).uniform(0, 10, (300, 3))

    def energy(x):
        index, d = region.surface(x, cutoff)
        return np.bincount(index, (cutoff - np.sqrt((d * d).sum(axis=1)))**2, len(x))
    index, d = region.surface(x, cutoff)
    r = np.sqrt((d * d).sum(axis=1))
    assert len(index) > 20 and region.inside(x[index]).all()
    points = x[index] - d       # on the surface: a step further is outside, unless the face goes on beyond its edge
    assert region.inside(points + 1e-6 * d / r[:, None]).mean() > 0.9
    assert region.inside(points - 1e-6 * d / r[:, None]).mean() < 0.1
    slope = 2 * (r - cutoff)[:, None] * d / r[:, None]
    slope = np.stack([np.bincount(index, slope[:, k], len(x)) for k in range(3)], axis=1)
    for k in range(3):
        step = h * np.eye(3)[k]
        assert slope[:, k] == pytest.approx((energy(x + step) - energy(x - step)) / (2 * h), abs=1e-5)
    lmp.close()


def test_no_surface():
    lmp = ran(["region all block 0 10 0 10 0 10", "create_box 1 all", "create_atoms 1 single 5 5 5", "mass 1 1",
               "region e ellipsoid 5 5 5 3 2 1",
               "region o sphere 5 5 5 3 open 1", "region p prism INF INF 0 1 0 1 0 0 0", "region u union 2 e all",
               "region s sphere 2 2 2 1"])
    for words, message in (("e harmonic 1 1 1", "style ellipsoid.*not supported"), ("o harmonic 1 1 1", "open faces"),
                           ("p harmonic 1 1 1", "INF"), ("u harmonic 1 1 1", "style ellipsoid"), ("all colloid 1 1 1", "radius"),
                           ("s harmonic 1 1 1", "atom 1 is on the surface of region s or outside"), ("x harmonic 1 1 1", "region"),
                           ("s harmoni 1 1 1", "did you mean harmonic"), ("s morse 1 1 1", "4 values"), ("s lj93 1 1 0", "above 0"),
                           ("s lj126 1 x 1", "number"), ("s", "2 values")):
        with pytest.raises(AsemdError, match=message):
            lmp.command(f"fix f all wall/region {words}")
            lmp.command("run 1")
        if "f" in lmp.session.scene.fixes:
            lmp.command("unfix f")
    lmp.command("fix f all wall/region s morse 1.0 2 3 4")
    assert lmp.session.scene.fixes["f"].to_lammps() == ["s", "morse", "1.0", "2.0", "3.0", "4.0"]
    lmp.close()


def test_colloid_wall():
    r, h = np.array([0.5, 1.0, 2.0]), 1e-6
    e, slope = colloid(r, 0.3, 4.0, 0.5)
    assert slope == pytest.approx((colloid(r + h, 0.3, 4.0, 0.5)[0] - colloid(r - h, 0.3, 4.0, 0.5)[0]) / (2 * h), rel=1e-6)
    assert abs(slope) == pytest.approx([34.00321356, 0.08572072, 0.00470898], rel=1e-6)      # LAMMPS
    assert e[0] > 0.0 > e[1]
