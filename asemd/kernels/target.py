"""How kernels are compiled: for which processor, which numba settles when the first function is decorated, and each function once.
So `njit` is taken from here."""
from __future__ import annotations

from functools import cached_property
from typing import ClassVar

import numba
from numba import njit as njit
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen

from asemd.kernels import compiling

OURS = "_ZN13asemd_kernels"      # with which names of functions in generated modules begin
LONG = 250      # instructions, more than functions have that LLVM puts in the place of calls


def prefer_wide_vectors() -> None:
    """Let LLVM use 512-bit vectors where the processor has them: it prefers 256 bits on Intel, which costs these kernels a fifth."""
    if numba.config.CPU_FEATURES is None and numba.config.CPU_NAME is None and not numba.config.DISABLE_JIT:
        import llvmlite.binding as llvm
        features = llvm.get_host_cpu_features()
        if features.get("avx512f"):
            numba.config.CPU_FEATURES = features.flatten() + ",-prefer-256-bit"


prefer_wide_vectors()


class OwnCopies(JITCodeLibrary):
    """Machine code of one function, in which others are not there a second time.

    numba puts copies of all that a function calls into its code, and of what that calls, optimises them once more and compiles them again.
    Of functions in generated modules only those become part of others that LLVM puts in the place of calls; the rest is called where it is.
    Copies of others, numba's own, are local: they all have one name, under which the one is called that was loaded first, and as copies
    are not rounded alike, the last bit of a result depended on what else was loaded.
    """

    known: ClassVar[dict[str, OwnCopies]] = {}      # by the name of their function
    kept: tuple | None = None

    def finalize(self):
        for library in self._linking_libraries:
            self._reload_init |= library._reload_init
        self._linking_libraries = [library for library in self._linking_libraries if not library.stays_apart]
        super().finalize()

    @cached_property
    def stays_apart(self) -> bool:
        """Whether the function is too long to be put in the place of a call."""
        module = self._get_module_for_linking()
        return any(function.linkage.name == "available_externally" and not any(b"alwaysinline" in a for a in function.attributes)
                   and LONG < sum(1 for block in function.blocks for _ in block.instructions) for function in module.functions)

    def _optimize_final_module(self):
        passes = self._codegen._module_pass_manager()
        # numba runs all passes twice, so that references are looked for in what was put in the place of calls; kernels count none
        if isinstance(passes, tuple) and numba.config.LLVM_REFPRUNE_PASS:
            passes[0].run(self._final_module, passes[1])
        else:      # versions before pass managers of that kind
            super()._optimize_final_module()
        self.calls = {f.name: self.known[f.name] for f in self._final_module.functions if f.is_declaration and f.name in self.known}
        shared = self._final_module.clone()      # for code that may have this in its place
        for function in shared.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.linkage = "available_externally" if function.name.startswith(OURS) else "linkonce_odr"
        self._shared_module = shared
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"

    def _finalize_final_module(self):
        super()._finalize_final_module()
        self.known.update((f.name, self) for f in self._shared_module.functions if f.linkage.name == "available_externally")

    def serialize_using_object_code(self):
        """What the cache keeps of this, with all that it calls."""
        if self.kept is None:
            called = {name: library.serialize_using_object_code() for name, library in self.calls.items()}
            self.kept = *super().serialize_using_object_code(), called
        return self.kept

    @classmethod
    def _unserialize(cls, codegen, state):
        called = state[3] if len(state) > 3 else {}      # versions before kept copies
        calls = {name: cls.known.get(name) or cls._unserialize(codegen, kept) for name, kept in called.items()}
        self = super()._unserialize(codegen, state[:3])
        self.calls, self.kept = calls, state
        return self


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
