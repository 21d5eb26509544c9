"""What acts on a body and what holds it: loads, tractions on faces, given stresses, supports and their reactions."""

from .load import LoadForm, StiffnessForm

__all__ = ["LoadForm", "StiffnessForm"]
