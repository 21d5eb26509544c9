"""What a solve can refuse."""


class SolveError(RuntimeError):
    """There is no answer that can be trusted."""


class NotConverged(SolveError):
    """An iteration stopped before its goal."""


class SingularSystem(SolveError):
    """The system has no unique solution: rigid motions are free, or multipliers that no displacement feels."""


class NotCoercive(SolveError):
    """K - K_γ is not positive: γ is too large."""
