"""Calls replaced by what they call, in the text of kernels: one function instead of twenty compiles several times faster."""
from __future__ import annotations

import ast
import copy
from collections.abc import Mapping, Sequence


class _Rename(ast.NodeTransformer):
    """Arguments become what is handed over, variables of the function get its name as well."""

    def __init__(self, given: Mapping[str, ast.expr], own: set[str], suffix: str):
        self.given, self.own, self.suffix = given, own, suffix

    def visit_Name(self, node):
        if node.id in self.given:
            return copy.deepcopy(self.given[node.id])
        return ast.Name(f"{node.id}_{self.suffix}", node.ctx) if node.id in self.own else node


class _Fold(ast.NodeTransformer):
    """Whole numbers with names are written out and added up."""

    def __init__(self, constants: Mapping[str, int]):
        self.constants = constants

    def visit_Name(self, node):
        known = isinstance(node.ctx, ast.Load) and node.id in self.constants
        return ast.Constant(self.constants[node.id]) if known else node

    def visit_BinOp(self, node):
        self.generic_visit(node)
        a, b = (getattr(side, "value", None) for side in (node.left, node.right))
        if type(a) is int and type(b) is int and isinstance(node.op, (ast.Add, ast.Mult)):
            return ast.Constant(a + b if isinstance(node.op, ast.Add) else a * b)
        return node


class _Paste(ast.NodeTransformer):
    def __init__(self, functions: Mapping[str, ast.FunctionDef]):
        self.functions = functions

    def _called(self, node):
        name = node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""
        return self.functions.get(name)

    def _body(self, call: ast.Call, function: ast.FunctionDef) -> list[ast.stmt]:
        names = [a.arg for a in function.args.args]
        own = {n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)} - set(names)
        rename = _Rename(dict(zip(names, call.args)), own, function.name)
        return [self.visit(s) for s in map(rename.visit, copy.deepcopy(function.body))]

    def _statements(self, node, wrap):
        function = self._called(node.value)
        if function is None:
            self.generic_visit(node)
            return node
        *body, last = self._flat(self._body(node.value, function))
        return [*body, wrap(last.value) if isinstance(last, ast.Return) else last]

    def _flat(self, body):
        return [s for one in body for s in (one if isinstance(one, list) else [one])]

    def visit_Expr(self, node):
        return self._statements(node, ast.Expr)

    def visit_Assign(self, node):
        return self._statements(node, lambda value: ast.Assign(node.targets, value))

    def visit_AugAssign(self, node):
        return self._statements(node, lambda value: ast.AugAssign(node.target, node.op, value))


def paste(text: str, helpers: Sequence[str], constants: Mapping[str, int]) -> str:
    """The text of a function with the bodies of helpers in place of calls of them.

    Parameters
    ----------
    helpers : sequence of str
        Texts of functions; only a last statement may return. They are pasted where a whole statement is a call of them, or an assignment of
        what they return; what they are handed is written out wherever they use it.
    constants : mapping
        Whole numbers to be written out.
    """
    functions: dict[str, ast.FunctionDef] = {}
    for helper in [*helpers, text]:
        tree = _Paste(dict(functions)).visit(ast.parse(helper))
        functions[tree.body[0].name] = tree.body[0]
    return ast.unparse(ast.fix_missing_locations(_Fold(constants).visit(tree)))
