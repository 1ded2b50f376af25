"""WHAM: the free energy behind histograms of runs that were each held elsewhere, for the workflows that use umbrellas."""
from __future__ import annotations

import numpy as np
from scipy.optimize import minimize
from scipy.special import logsumexp


def wham(histograms: np.ndarray, bias: np.ndarray) -> np.ndarray:
    """Free energy of the bins (kT), infinite where nothing was seen.

    Parameters are the counts and the bias energies (kT) of the bins, both (windows, bins). The equations of S. Kumar et al., J. Comput.
    Chem. 13, 1011 (1992), as the minimum of a convex function: F. Zhu, G. Hummer, J. Comput. Chem. 33, 453 (2012).
    """
    seen, counts = histograms.sum(axis=0), histograms.sum(axis=1)
    full = seen > 0
    bias, few = bias[:, full], seen[full]

    def function(f):
        total = logsumexp(f[:, None] - bias, axis=0, b=counts[:, None])
        return few @ total - counts @ f, (np.exp(f[:, None] - bias - total) * counts[:, None]) @ few - counts
    f = minimize(function, np.zeros(len(bias)), jac=True, method="L-BFGS-B", options={"maxiter": 5000, "ftol": 1e-15, "gtol": 1e-3}).x
    energy = np.full(len(seen), np.inf)
    energy[full] = logsumexp(f[:, None] - bias, axis=0, b=counts[:, None]) - np.log(few)
    return energy - energy.min()
