"""Bilinear forms on spaces on cracks."""

from __future__ import annotations

from functools import singledispatch

from ngsolve import BilinearForm

from .. import _ngsxfem_contact as core


@singledispatch
def bilinear_form(V: core.CrackFESpace) -> BilinearForm:
    """A symmetric one, with the storage that suits the space: the long rows of functions at tips are written directly."""
    return core.CrackBilinearForm(V, symmetric=True)


@bilinear_form.register(core.SolidFESpace)
def plain_form(V: core.SolidFESpace) -> BilinearForm:
    """NGSolve's own: modes of fronts couple neighbours only."""
    return BilinearForm(V, symmetric=True)
