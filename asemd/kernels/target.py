"""How kernels are compiled: for which processor, which numba settles when the first function is decorated, and that the code of each calls
nobody else's copies. So `njit` is taken from here."""
from __future__ import annotations

import numba
from numba import njit as njit
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen

from asemd.kernels import compiling


def prefer_wide_vectors() -> None:
    """Let LLVM use 512-bit vectors where the processor has them: it prefers 256 bits on Intel, which costs these kernels a fifth."""
    if numba.config.CPU_FEATURES is None and numba.config.CPU_NAME is None and not numba.config.DISABLE_JIT:
        import llvmlite.binding as llvm
        features = llvm.get_host_cpu_features()
        if features.get("avx512f"):
            numba.config.CPU_FEATURES = features.flatten() + ",-prefer-256-bit"


prefer_wide_vectors()


class OwnCopies(JITCodeLibrary):
    """Machine code that calls its own copies of functions that other code has, too.

    numba gives all copies one name, and calls go to the copy that was loaded first. Copies are not rounded alike, for each was optimised
    with what is around it, so that the last bit of a result depended on what else was loaded, and on whether it came from the cache.
    """

    def _optimize_final_module(self):
        super()._optimize_final_module()
        shared = self._final_module.clone()      # for code that will have copies of this
        for function in shared.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.linkage = "linkonce_odr"
        self._shared_module = shared
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"


JITCPUCodegen._library_class = OwnCopies
compiling.install()


def many_registers() -> bool:
    """Whether there are 32 vector registers (AVX-512), and not 16."""
    return "+avx512f" in (numba.config.CPU_FEATURES or "")


def lanes(single: bool) -> int:
    """What rows of neighbours are padded to: numbers per vector, and at least 8.

    Sixteen single-precision numbers on a processor whose vectors hold eight take half as long again as they should.
    """
    return 16 if single and many_registers() else 8


def vector(single: bool) -> int:
    """Numbers per vector, at least 4: the stretches of rows that loops run over consist of whole ones."""
    return lanes(single) if single or many_registers() else 4
