"""What makes numba's work on its intermediate code faster; what comes out is the same.

- Variables: all that is in a statement is looked through for them, ever again, with a generator for each value.
- Lifetimes: after most passes numba works out which variables live where, and forgets it in the next; needed it is where they
  are let go, and all of it for generators and code with Python's objects only.
- Single assignments: for each variable that is assigned twice all statements are looked at, two times; here those of blocks that have it.
- References: variables that hold none are loaded to be let go, and cleared, which LLVM has to remove again.
"""
from __future__ import annotations

from numba.core import analysis, ir, ssa, transforms
from numba.core.lowering import Lower
from numba.core.postproc import PostProcessor, VariableLifetime

KINDS: dict[type, int] = {}      # what values of a class are to `collect`
work_out, rewrite_all, single, let_go, keep = PostProcessor.run, ssa._run_block_rewrite, ssa._run_ssa, Lower.delvar, Lower.storevar
inside: dict[int, set[str]] = {}      # names of the variables in each block of the function that is rewritten


def list_vars(self, value) -> list:
    """The variables of numba's intermediate code in a value, which are those of its parts."""
    out: list = []
    collect(value, out)
    return out


def collect(value, out: list) -> None:
    kind = value.__class__
    what = KINDS.get(kind)
    if what is None:
        what = KINDS[kind] = next((n for n, base in enumerate((ir.Var, (list, tuple), dict, ir.Inst)) if issubclass(kind, base)), 4)
    if what == 0:
        out.append(value)
    elif what == 3:
        out += value.list_vars()
    elif what < 4:
        for part in value if what == 1 else value.values():
            collect(part, out)


def process(self, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """What follows passes. Lifetimes are worked out when they are asked for."""
    code = self.func_ir
    if code.is_generator:
        work_out(self, emit_dels, extend_lifetimes)
        return
    code.blocks = transforms.canonicalize_cfg(code.blocks)
    code.variable_lifetime, code.generator_info = VariableLifetime(code.blocks), None
    code.block_entry_vars = {}
    if emit_dels:
        self._insert_var_dels(extend_lifetimes=extend_lifetimes)


def entry_variables(self, block) -> set[str]:
    """The variables at the entry of a block, which only generators and code with Python's objects need."""
    if not self.block_entry_vars:
        lives = self.variable_lifetime
        entries = analysis.compute_live_variables(lives.cfg, self.blocks, lives.usedefs.defmap, lives.deadmaps.combined)
        self.block_entry_vars = {one: entries[label] for label, one in self.blocks.items()}
    return self.block_entry_vars[block]


def rewrite(blocks, states, handler):
    """Blocks after a pass that changes one variable: those that have it are passed."""
    name, out = states["varname"], {}
    for label, block in blocks.items():
        names = inside.get(label)
        if names is None:
            names = inside[label] = {v.name for statement in block.body for v in statement.list_vars()}
        out.update(rewrite_all({label: block}, states, handler) if name in names else {label: block})
    return out


def run_ssa(blocks):
    """Assign each variable once."""
    inside.clear()
    return single(blocks)


def counted(self, name: str) -> bool:
    """Whether a variable has references to count; always where it is shown to a debugger, or outlives the call that sets it."""
    if self._disable_sroa_like_opt or self.generator_info:
        return True
    return self.context.data_model_manager[self.typeof(name)].contains_nrt_meminfo()


def delvar(self, name: str) -> None:
    """Let a variable go."""
    if counted(self, name):
        let_go(self, name)
    elif name not in self._blk_local_varmap:
        self._singly_assigned_vars.discard(name)      # it goes before it comes


def storevar(self, value, name: str, argidx=None) -> None:
    """Keep a value in a variable, whose former one is not let go first where it holds no references."""
    if argidx is not None or name in self._singly_assigned_vars or counted(self, name):
        keep(self, value, name, argidx)
        return
    self._alloca_var(name, self.typeof(name))
    self.builder.store(value, self.getvar(name))


def install() -> None:
    """For the whole process."""
    ir.Inst._rec_list_vars, ir.FunctionIR.get_block_entry_vars = list_vars, entry_variables
    PostProcessor.run = process
    ssa._run_ssa, ssa._run_block_rewrite = run_ssa, rewrite
    Lower.delvar, Lower.storevar = delvar, storevar
