r"""The sum of lj/spica up to cut_lj and coul/msm up to cut_coul, for multilevel summation; one cutoff given means both."""
from __future__ import annotations

import inspect

from asemd.pair.coul_msm import coul_msm
from asemd.pair.lj_spica_coul_long import SpicaLongPair
from asemd.style import register

register(SpicaLongPair("lj/spica/coul/msm", coul_msm, inspect.cleandoc(__doc__)))
