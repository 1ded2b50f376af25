"""Chains of beads as random walks, where the workflows on polymers start."""
from __future__ import annotations

from pathlib import Path

import numpy as np


def build(path, chains: int, beads: int, density: float = 0.85, seed: int = 1) -> None:
    """Write a data file of random walks with bonds of 0.97 that never fold back (next-nearest beads are at least 1.02 apart)."""
    rng = np.random.default_rng(seed)
    n, length = chains * beads, (chains * beads / density) ** (1 / 3)
    steps = np.empty((chains, beads - 1, 3))
    for k in range(beads - 1):
        todo = np.ones(chains, bool)
        while todo.any():
            s = rng.normal(size=(int(todo.sum()), 3))
            steps[todo, k] = 0.97 * s / np.linalg.norm(s, axis=1)[:, None]
            todo = np.linalg.norm(steps[:, k] + steps[:, k - 1], axis=1) < 1.02 if k else np.zeros(chains, bool)
    x = np.concatenate([np.zeros((chains, 1, 3)), steps.cumsum(axis=1)], axis=1) + rng.uniform(0, length, (chains, 1, 3))
    x = x.reshape(n, 3)
    image = np.floor(x / length).astype(int)
    x -= image * length
    first = np.array([c * beads + b for c in range(chains) for b in range(1, beads)])
    lines = ["bead-spring melt", "", f"{n} atoms", f"{len(first)} bonds", "1 atom types", "1 bond types", ""]
    lines += [f"0 {length:.15g} {d}lo {d}hi" for d in "xyz"] + ["", "Masses", "", "1 1.0", "", "Atoms # bond", ""]
    lines += [f"{i + 1} {i // beads + 1} 1 {x[i, 0]:.15g} {x[i, 1]:.15g} {x[i, 2]:.15g} {image[i, 0]} {image[i, 1]} {image[i, 2]}"
              for i in range(n)]
    lines += ["", "Bonds", ""] + [f"{k + 1} 1 {i} {i + 1}" for k, i in enumerate(first)]
    Path(path).write_text("\n".join(lines) + "\n")
