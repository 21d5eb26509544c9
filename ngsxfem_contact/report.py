"""What a solve did: counts, times and residuals."""

from dataclasses import dataclass, field
from time import perf_counter


@dataclass
class Report:
    """What a solve did.

    inverse: the direct solver.    active: the active set of each iteration, the first is where it started.
    coarse_iterations: on the coarser problems that gave the first set.    fallback: steps of least-index pivoting.
    residual: of the first row of (38), relative.    complementarity: relative violation of the signs. Both are measured
    when u is recovered and NaN before (LoadSteps).    timings: seconds.
    """

    unknowns: tuple
    inverse: str = ""
    timings: dict = field(default_factory=dict)
    converged: bool = False
    iterations: int = 0
    active: list = field(default_factory=list)
    coarse_iterations: int = 0
    fallback: int = 0
    residual: float = float("nan")
    complementarity: float = float("nan")

    def __str__(self):
        sizes = " ".join(str(int(a.sum())) for a in self.active)
        times = "  ".join(f"{name} {seconds:.3f}" for name, seconds in self.timings.items())
        return "\n".join(
            [
                f"unknowns         {self.unknowns[0]} displacement, {self.unknowns[1]} multiplier",
                f"direct solver    {self.inverse}",
                f"converged        {self.converged} after {self.iterations} active-set iterations ({self.coarse_iterations} on coarser sets before)",
                f"in contact       {sizes}" + (f"  (+ {self.fallback} least-index steps)" if self.fallback else ""),
                f"residual         {self.residual:.1e}",
                f"complementarity  {self.complementarity:.1e}",
                f"seconds          {times}",
            ]
        )


class Stopwatch:
    """Seconds since the last mark, by name."""

    def __init__(self, timings):
        self.timings, self.last = timings, perf_counter()

    def Mark(self, name):
        """Books the time since the last mark."""
        now = perf_counter()
        self.timings[name], self.last = now - self.last, now
