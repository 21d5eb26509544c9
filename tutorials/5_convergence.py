# %% [markdown]
# # 5. Convergence, and the paper's figures
#
# How fast do the errors fall with the mesh size? Section 4 of the paper answers for five pairs of spaces and five meshes. The whole study is one command,
#
#     python -m study
#
# and takes some twenty minutes; what it found is on the page [claim by claim](../paper.md). Here is a small one: three structured meshes, errors against a P2/P1
# solution on 45 × 45 squares.

# %%
import tempfile

import matplotlib.pyplot as plt
from ngsolve import *
from ngsxfem_contact import *

# the folder `study` lies beside the package, in its sources; the environment of `make` finds it
from study import figures
from study.study import Study

folder = tempfile.mkdtemp()
study = Study(folder, sizes=(0.088, 0.05, 0.03), realisations=1, structured=True, cells=45)
records = study.Run()
converged = [r for r in records if r["kind"] == "convergence" and r["error"]]
print(len(records), "records, errors in", len(converged), "of them")

# %% [markdown]
# ## The reference (figure 7)
#
# The von Mises stress on the deformed body, and the contact stress along the crack. Lemma A.1 of the paper says that $\sigma_n$ stays finite at a closed tip: the figure agrees.

# %%
figures.reference_von_mises(study.reference.solution)
figures.reference_contact_stress(study.reference.solution)
plt.show()

# %% [markdown]
# ## Errors without stabilisation (figure 8)
#
# Relative errors of the displacement in $L^2(\Omega)$ and $H^1(\Omega)$ and of the multiplier in $L^2(\Gamma_C)$; in brackets the fitted slopes. The
# multipliers that go with P1 do not converge: spurious modes, as in tutorial 4. (On unstructured meshes P1/P1 is singular.) The displacement does not mind.

# %%
figures.convergence(records, "none")
plt.show()

# %% [markdown]
# ## Errors with stabilisation (figure 9)
#
# Now all pairs converge. P2 gains over P1, but less than a whole order on finer meshes: $u$ has just less than 5/2 derivatives where contact ends, since the gap
# opens like $x^{3/2}$, so that the rate in $H^1$ tends to 3/2.

# %%
figures.convergence(records, "larger")
plt.show()

# %% [markdown]
# ## The rates as a table

# %%
for rate in figures.fitted_rates(records):
    if rate["cone"] == "nonpositive" and rate["stabilisation"] in ("none", "larger"):
        slopes = " ".join(f"{name} {'-' if rate[name] is None else format(rate[name], '.2f'):>5} " for name in ("L2", "H1", "multiplier"))
        print(f"{rate['pair']:7} {rate['stabilisation']:7} {slopes}")

# %% [markdown]
# ## Is it right?
#
# With few and coarse meshes the slopes are rough; what must hold even here: P2 has a better rate than P1 in both norms of $u$, the $H^1$ norm of P1 has order 1 (14), and with
# stabilisation no pair is without an answer.

# %%
slopes = {rate["pair"]: rate for rate in figures.fitted_rates(records) if (rate["cone"], rate["stabilisation"]) == ("nonpositive", "larger")}
assert set(slopes) == {"P2/P1", "P2/P0", "P1+/P1", "P1/P1", "P1/P0"}
assert slopes["P2/P1"]["L2"] > slopes["P1/P1"]["L2"] and slopes["P2/P1"]["H1"] > slopes["P1/P1"]["H1"]
assert 0.9 < slopes["P1/P1"]["H1"] < 1.2
