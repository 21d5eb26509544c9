"""Formulas written as text: numbers, + - * / **, pi, the names of coordinates, a few functions. They are parsed, never executed."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import ngsolve

if TYPE_CHECKING:
    from ..material import Coefficient

OPERATORS: dict[type, Callable[..., Any]] = {
    **{ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow},
    **{ast.USub: operator.neg, ast.UAdd: operator.pos},
}
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log")
LONGEST = 2000  # characters


class NoFormula(ValueError):
    """A text is no formula; the message says where, and what a formula may hold."""


def evaluated(text: str, names: dict[str, Coefficient]) -> Coefficient:
    """The value of a formula: a number, or a CoefficientFunction where a name in it is one.

    names: what the formula may call by name → its value, beside pi.    Raises NoFormula for everything else than arithmetic with finite real numbers.

    >>> evaluated("2*sqrt(t) + 1e3", {"t": 4.0})
    1004.0
    """
    if len(text) > LONGEST:
        raise NoFormula(f"it has {len(text)} characters, more than {LONGEST}")
    try:
        value = _value(ast.parse(text.strip(), mode="eval").body, {"pi": math.pi, **names})
    except NoFormula as error:
        raise NoFormula(f"{text!r} is no formula: {error}") from None
    except (SyntaxError, RecursionError, MemoryError, ValueError) as error:
        raise NoFormula(f"{text!r} is no formula: {getattr(error, 'msg', error)}") from None
    except ArithmeticError as error:
        raise NoFormula(f"{text!r} has no value: {error}") from None
    if isinstance(value, float | complex) and not (isinstance(value, float) and math.isfinite(value)):
        raise NoFormula(f"{text!r} has the value {value}, which is no finite real number")
    return value


def _value(node: ast.AST, names: dict[str, Coefficient]) -> Any:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        return float(node.value)
    if isinstance(node, ast.Name):
        return _named(node.id, names)
    if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](_value(node.operand, names))
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return _applied(node.op, _value(node.left, names), _value(node.right, names))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and len(node.args) == 1 and not node.keywords:
        return _called(node.func.id, _value(node.args[0], names))
    raise NoFormula(f"{ast.unparse(node)!r} is not allowed; {allowed(names)}")


def allowed(names: dict[str, Coefficient]) -> str:
    """What a formula may hold, in words."""
    return f"allowed are numbers, + - * / **, {', '.join(names)} and {', '.join(FUNCTIONS)} of one argument"


def _named(name: str, names: dict[str, Coefficient]) -> Coefficient:
    if name not in names:
        raise NoFormula(f"there is no {name!r}; {allowed(names)}")
    return names[name]


def _applied(op: ast.operator, left: Coefficient, right: Coefficient) -> Any:
    if isinstance(op, ast.Pow) and isinstance(right, float) and not isinstance(left, float) and right.is_integer() and abs(right) < 100:
        right = int(right)  # NGSolve's powers to floats are NaN where the base is negative
    return OPERATORS[type(op)](left, right)


def _called(name: str, argument: Coefficient) -> Coefficient:
    if name not in FUNCTIONS:
        raise NoFormula(f"there is no function {name!r}; there are {', '.join(FUNCTIONS)}")
    return getattr(math if isinstance(argument, float) else ngsolve, name)(argument)
