"""Atoms and cells that are made to break neighbour lists: tiny, flat, sheared, left-handed, crowded, empty, far outside."""
from __future__ import annotations

import numpy as np
from brute import CELLS

ALL = (True, True, True)
SHEARED = np.array([[9.0, 0, 0], [25.0, 8.0, 0], [-31.0, 17.0, 9.5]])       # tilts of 2.8, -3.4 and 2.1 box lengths
WIDE = np.array([[14.0, 0, 0], [13.0, 11.0, 0], [-9.0, 12.0, -15.0]])       # left-handed, tilts beyond a half, room for clusters


def anywhere(n, cell, rng, periodic=ALL, turns: int = 0) -> np.ndarray:
    """Atoms anywhere in the cell, moved by up to `turns` cells along periodic directions."""
    return (rng.random((n, 3)) + rng.integers(-turns, turns + 1, (n, 3)) * np.array(periodic)) @ cell


def lattice(m, cell) -> np.ndarray:
    """Sites on faces, edges and corners."""
    return np.stack(np.meshgrid(*(np.arange(k) / k for k in m), indexing="ij"), -1).reshape(-1, 3) @ cell


def scenes() -> dict[str, tuple]:
    """Positions, cell, which directions are periodic, cutoff."""
    rng = np.random.default_rng(17)
    box = np.diag([9.0, 10.0, 11.0])
    drops = np.concatenate([np.random.default_rng(k).normal(0, 1, (200 - 50 * k, 3)) + k * WIDE.sum(0) * 4 for k in (0, 1)])
    out = {
        "single atom": (np.array([[0.3, 0.2, 0.1]]), np.diag([2.0, 3.0, 2.5]), ALL, 4.1),
        "single atom, nothing periodic": (np.array([[0.3, 0.2, 7.1]]), box, (False,) * 3, 4.1),
        "two atoms, one place but for an image": (np.array([[0.0, 0, 0], [9.0, -10.0, 21.9]]), box, ALL, 3.0),
        "needle": (anywhere(30, np.diag([0.41, 0.5, 60.0]), rng, turns=3), np.diag([0.41, 0.5, 60.0]), ALL, 1.3),
        "sheet": (anywhere(40, np.diag([9.0, 8.0, 0.05]), rng), np.diag([9.0, 8.0, 0.05]), ALL, 0.8),
        "sheet without images": (anywhere(300, np.diag([30.0, 29.0, 1e-3]), rng), np.diag([30.0, 29.0, 1e-3]), (True, True, False),
                                 2.2),
        "all atoms in one plane": (anywhere(300, np.diag([30.0, 29.0, 0.0]), rng) + 4.0, np.diag([30.0, 29.0, 9.0]), ALL, 2.2),
        "all atoms on one line": (anywhere(300, np.diag([0.0, 90.0, 0.0]), rng), np.diag([9.0, 90.0, 9.0]), (False, True, False), 2.2),
        "cutoff of five boxes": (anywhere(3, CELLS["tiny and tilted"], rng), CELLS["tiny and tilted"], ALL, 6.0),
        "cutoff of one periodic length": (anywhere(6, np.diag([2.0, 3.0, 4.0]), rng), np.diag([2.0, 3.0, 4.0]), ALL, 2.0),
        "sheared": (anywhere(90, SHEARED, rng, turns=2), SHEARED, ALL, 1.9),
        "sheared, mixed": (anywhere(90, SHEARED, rng, (True, False, True), 2), SHEARED, (True, False, True), 1.9),
        "left-handed and wide": (anywhere(400, WIDE, rng, turns=5), WIDE, ALL, 2.1),
        "left-handed and wide, mixed": (anywhere(400, WIDE, rng, (False, True, True), 5), WIDE, (False, True, True), 2.1),
        "far outside, nothing periodic": (anywhere(300, box, rng) + [1e5, -2e5, 3e4], box, (False,) * 3, 2.0),
        "far outside along periodic directions": (anywhere(300, box, rng, turns=10**6), box, ALL, 2.0),
        "sites on faces": (lattice((9, 10, 11), box)[::3], box, ALL, 2.0 + 1e-9),
        "sites on faces of a tilted cell": (lattice((6, 6, 6), CELLS["triclinic"]), CELLS["triclinic"], ALL, 2.0 + 1e-9),
        "a hair inside the upper face": (np.nextafter(lattice((6, 6, 6), box) + box.sum(0) / 6, 0.0), box, ALL, 2.4),
        "a point and one atom": (np.concatenate([rng.normal(5.0, 1e-3, (300, 3)), [[5.0, 5.0, 5.9]]]), box, ALL, 1.0),
        "a point on a corner": (rng.normal(0.0, 1e-3, (400, 3)), box, ALL, 1.0),
        "a point on a corner, mixed": (rng.normal(0.0, 1e-3, (400, 3)), box, (True, False, False), 1.0),
        "two drops in a large box": (np.concatenate([rng.normal(0, 1, (200, 3)), rng.normal(70, 1, (150, 3))]), np.eye(3) * 100, ALL, 2.0),
        "two drops across faces of a tilted cell": (drops, WIDE * 8, ALL, 2.0),
        "two drops across faces, mixed": (drops, WIDE * 8, (True, False, True), 2.0),
        "drop and outlier": (np.concatenate([rng.normal(0, 1, (300, 3)), [[1e7, -1e7, 1e7]]]), box, (False,) * 3, 1.0),
        "density from nothing to a crowd": (np.column_stack([11.0 * rng.random(400) ** 6, *rng.random((2, 400)) * 9]), box * 1.1, ALL,
                                                1.7),
        "gas": (anywhere(300, np.eye(3) * 60.0, rng, turns=1), np.eye(3) * 60.0, ALL, 3.0),
    }
    narrow = {"": np.diag([3.3, 4.0, 5.1]), ", tilted": np.array([[3.6, 0, 0], [1.7, 3.9, 0], [-1.5, 1.8, 4.2]]),
              ", left-handed": np.array([[4.4, 0.3, 0], [-1.2, 3.8, 0], [0.9, 1.1, -3.7]])}
    for word, cell in narrow.items():      # two images of an atom in reach of another
        for periodic in (ALL, (True, True, False)):
            out[f"narrow{word}{'' if all(periodic) else ', mixed'}"] = (anywhere(130, cell, rng, periodic, 2), cell, periodic, 2.7)
    out |= apart(np.random.default_rng(5))
    out["cutoff a hair above lattice distances"] = (lattice((6, 6, 6), np.eye(3) * 5.4), np.eye(3) * 5.4, ALL, 1.8 * (1 + 1e-12))
    return out


def apart(rng) -> dict[str, tuple]:
    """Atoms with much empty space between, along each direction and along all."""
    drop, line, far = rng.normal(0, 1, (4, 70, 3)), np.array([60.0, 3.0, -5.0]), np.array([300.0, -200.0, 150.0])
    places = (rng.random((5, 1, 3)) @ WIDE) * 6
    out = {
        "drops on a line": (np.concatenate([d + k * line for k, d in enumerate(drop)]), np.diag([240.0, 40, 40]), (True, True, False), 2.0),
        "drops in a tilted cell": ((places + rng.normal(0, 0.8, (5, 60, 3))).reshape(-1, 3), WIDE * 6, ALL, 2.0),
        "drop and gas far from it": (np.concatenate([*drop[:2], anywhere(60, np.eye(3) * 25.0, rng) + far]), np.eye(3), (False,) * 3, 3.0),
    }
    pairs = np.repeat(9.0 * np.arange(40), 2) + np.tile([0.0, 1.1], 40)
    out["pairs on a line"] = (np.column_stack([np.full((80, 2), 3.0), pairs]), np.diag([6.0, 6.0, 360.0]), ALL, 2.0)
    for axis, word in enumerate("xyz"):
        thick, away = np.full(3, 13.0), np.eye(3)[axis] * 70.0
        thick[axis] = 3.5
        slabs = [anywhere(count, np.diag(thick), rng) + at * away for count, at in ((100, 0.0), (100, 1.0), (3, 0.4))]
        out[f"slabs apart along {word}"] = (np.concatenate(slabs), np.diag(thick + 1.5 * away), ALL, 2.0)
    return out


SCENES = scenes()
OVER_CLUSTERS = [name for name, (x, cell, periodic, cut) in SCENES.items()
                 if len(x) > 1 and all(cut < w for w, p in zip(1 / np.linalg.norm(np.linalg.inv(cell), axis=0), periodic) if p)]
