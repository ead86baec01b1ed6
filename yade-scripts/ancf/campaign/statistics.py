"""What a campaign says: probabilities with confidence, maps, and what matters for the outcome."""

import dataclasses
import math

import numpy as np

from .. import values
from ..needs import needed

with needed("python3-scipy"):
    from scipy import linalg, special, stats

METHODS = ("wilson", "exact")
CONFIDENCE = 0.95
GROUPS = 5  # equally large ones, of a parameter's values
STEPS = 50  # of Newton's method, which takes about six
FARTHEST = 15  # log-odds a deviation; beyond it a parameter alone tells the outcome


@dataclasses.dataclass(frozen=True)
class Probability:
    """successes of runs, the share of them and its confidence interval."""

    successes: int
    runs: int
    share: float
    low: float
    high: float

    def __str__(self):
        return f"{self.share:.3f} ({self.low:.3f} to {self.high:.3f}), {self.successes} of {self.runs} runs"


def probability(success, confidence=CONFIDENCE, method="wilson"):
    """Probability of success and its confidence interval, from an outcome a run.

    method   'wilson': score interval, which covers its confidence on average; 'exact':
             Clopper-Pearson, which covers at least that always
    """
    success = _outcomes("probability", success)
    values.choice("probability: method", method, METHODS)
    successes, runs = int(success.sum()), len(success)
    interval = stats.binomtest(successes, runs).proportion_ci(_confidence(confidence), method)
    return Probability(successes, runs, successes / runs, float(interval.low), float(interval.high))


def _confidence(confidence):
    if not 0 < values.finite("probability: confidence", confidence, "") < 1:
        values.refuse("probability: confidence", confidence, "must be between 0 and 1")
    return confidence


def _outcomes(where, success):
    """Outcomes as an array of True and False; refused if they are not, or if there are none."""
    success = np.asarray(success, float)
    if success.ndim != 1 or not len(success):
        raise ValueError(
            f"{where}: success has the shape {success.shape}: give an outcome a run, at least one"
        )
    if not np.isin(success, (0, 1)).all():
        odd = success[~np.isin(success, (0, 1))][0]
        values.refuse(f"{where}: success", float(odd), "must be True or False, 1 or 0, in each run")
    return success.astype(bool)


def _column(where, values_, runs):
    column = np.asarray(values_, float)
    if column.shape != (runs,) or not np.isfinite(column).all():
        raise ValueError(f"{where}: must be finite numbers, one for each of the {runs} runs")
    return column


@dataclasses.dataclass(frozen=True)
class Map:
    """Successes and runs in the cells (x, y) of a grid, given by its edges."""

    x: np.ndarray
    y: np.ndarray
    successes: np.ndarray
    runs: np.ndarray

    @property
    def share(self):
        """Successes as part of the runs; nan where there was none."""
        with np.errstate(invalid="ignore"):
            return np.where(self.runs > 0, self.successes / self.runs, np.nan)


def successMap(x, y, success, bins=8):
    """Map of success over two parameters, in bins x bins cells of equal size."""
    success = _outcomes("successMap", success)
    x, y = (_column(f"successMap: {n}", v, len(success)) for n, v in (("x", x), ("y", y)))
    bins = values.count("successMap: bins", bins, 1)
    runs, edgesX, edgesY = np.histogram2d(x, y, bins)
    successes, _, _ = np.histogram2d(x[success], y[success], [edgesX, edgesY])
    return Map(edgesX, edgesY, successes.astype(int), runs.astype(int))


@dataclasses.dataclass(frozen=True)
class Sensitivity:
    """How an outcome depends on one parameter.

    rank         Spearman's rank correlation with success, -1 to 1
    oddsRatio    by which the odds of success grow with one standard deviation of the parameter, the
                 others unchanged: logistic regression; low, high: its confidence interval. nan where
                 the parameters separate success from failure
    groups       Probability in each of five equally large groups of its values, smallest first
    chance       probability of such differences between the groups by chance alone (chi-squared test):
                 also small where success is most likely in the middle
    """

    name: str
    rank: float
    oddsRatio: float
    low: float
    high: float
    groups: list
    chance: float


def sensitivities(parameters, success, confidence=CONFIDENCE):
    """A Sensitivity for each of {name: values}, the one with the largest differences first."""
    success = _outcomes("sensitivities", success)
    if success.all() or not success.any():
        raise ValueError(
            "sensitivities: every run has the same outcome: there is nothing to compare"
        )
    columns = {n: _column(f"sensitivities: {n}", v, len(success)) for n, v in parameters.items()}
    for name, column in columns.items():
        if np.ptp(column) == 0:
            values.refuse(
                f"sensitivities: {name}", column[0], "is the same in every run: leave it out"
            )
    factors, errors = logistic(np.column_stack(list(columns.values())), success)
    reach = stats.norm.ppf(0.5 + 0.5 * _confidence(confidence))
    found = []
    for (name, column), factor, error in zip(columns.items(), factors, errors):
        groups, chance = _groups(column, success, confidence)
        odds = np.exp([factor, factor - reach * error, factor + reach * error])
        rank = stats.spearmanr(column, success)[0]
        found.append(Sensitivity(name, float(rank), *map(float, odds), groups, chance))
    return sorted(found, key=_spread, reverse=True)


def _spread(sensitivity):
    shares = [group.share for group in sensitivity.groups]
    return max(shares) - min(shares)


def _groups(column, success, confidence):
    """Probability in groups of a parameter's values, and the chance of their differences."""
    edges = np.unique(np.quantile(column, np.linspace(0, 1, GROUPS + 1)[1:-1]))
    group = np.searchsorted(edges, column)
    parts = [success[group == k] for k in np.unique(group)]
    counts = [[part.sum(), (~part).sum()] for part in parts]
    chance = stats.chi2_contingency(counts)[1] if len(parts) > 1 else math.nan
    return [probability(part, confidence) for part in parts], float(chance)


def logistic(columns, success):
    """Logistic regression on columns (runs, parameters), each taken in its standard deviations: the
    log-odds a deviation, and their standard errors; nan where no finite ones fit best.
    """
    z = (columns - columns.mean(axis=0)) / columns.std(axis=0)
    design = np.column_stack([np.ones(len(z)), z])
    factors = np.zeros(design.shape[1])
    for _ in range(STEPS):  # Newton's method on the log-likelihood, which is concave
        p = special.expit(design @ factors)
        information = design.T * (p * (1 - p)) @ design
        try:
            change = linalg.solve(information, design.T @ (success - p), assume_a="pos")
        except linalg.LinAlgError:
            break
        factors += change
        if np.abs(factors).max() > FARTHEST:
            break
        if np.abs(change).max() < 1e-10:
            return factors[1:], np.sqrt(np.diag(linalg.inv(information)))[1:]
    return np.full((2, z.shape[1]), np.nan)
