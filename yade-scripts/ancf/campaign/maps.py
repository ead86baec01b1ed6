"""Pictures of a campaign's maps, by matplotlib without a screen."""

import numpy as np

from ..plots import plt
from .statistics import probability, successMap

READABLE = 12  # cells a side up to which numbers fit in


def plotMap(ax, found, xLabel, yLabel):
    """Draws a Map into axes: colour is the share of successes, and each cell says it and the number of
    runs. Returns what a colour bar needs.
    """
    image = ax.pcolormesh(found.x, found.y, found.share.T, vmin=0, vmax=1, cmap="RdYlBu")
    if max(found.runs.shape) <= READABLE:
        for i, j in np.argwhere(found.runs):
            at = (found.x[i : i + 2].mean(), found.y[j : j + 2].mean())
            text = f"{100 * found.share[i, j]:.0f} %\n{found.successes[i, j]}/{found.runs[i, j]}"
            color = "k" if 0.15 < found.share[i, j] < 0.85 else "w"
            ax.annotate(text, at, ha="center", va="center", fontsize=7, color=color)
    ax.set_xlabel(xLabel)
    ax.set_ylabel(yLabel)
    return image


def plotMaps(path, columns, success, pairs, labels, bins=8):
    """Writes a picture of success over pairs of parameters.

    columns  {name: values}, as Results.columns() gives them
    pairs    [(name, name), ...], a map each
    labels   {name: text with unit}
    """
    figure, axes = plt.subplots(
        1, len(pairs), figsize=(6.2 * len(pairs), 5.4), squeeze=False, layout="constrained"
    )
    for ax, (x, y) in zip(axes[0], pairs):
        image = plotMap(ax, successMap(columns[x], columns[y], success, bins), labels[x], labels[y])
    figure.colorbar(image, ax=axes[0].tolist(), label="share of successes")
    figure.suptitle(f"success, and its 95 % confidence interval: {probability(success)}")
    figure.savefig(path, dpi=110)
    plt.close(figure)
