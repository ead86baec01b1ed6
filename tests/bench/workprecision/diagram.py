"""Work-precision diagrams: error against CPU time, a line a method."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# One colour and marker a method wherever it appears: ours red, YADE's blue, other programs green.
STYLES = {
    "ANCF lumped": ("#c0392b", "o", "-"),
    "ANCF, relax": ("#c0392b", "o", "-"),
    "ANCF consistent": ("#e67e22", "s", "-"),
    "ANCF implicit": ("#8e44ad", "D", "-"),
    "ANCF lumped, one step in O.dt": ("#d98880", "o", ":"),
    "springs": ("#c9a227", "v", "-"),
    "YADE grid chain": ("#1f6fb2", "o", "--"),
    "YADE sphere chain": ("#5dade2", "s", "--"),
    "YADE wire chain": ("#34495e", "^", "--"),
    "Exudyn implicit": ("#1e8449", "D", "-."),
    "Exudyn explicit": ("#58d68d", "o", "-."),
    "CableDyn": ("#16a085", "^", "-."),
    "PyElastica": ("#7f8c8d", "P", "-."),
    "MuJoCo capsules": ("#000000", "X", "-."),
    "MuJoCo flex of springs": ("#000000", "X", "-."),
}


def best(rows):
    """The runs that none beats in both, by CPU time; what gains less than 5 % is left out."""
    front = []
    for row in sorted(rows, key=lambda r: (r.cpu, r.error)):
        if not front or row.error < 0.95 * front[-1].error:
            front.append(row)
    return front


def draw(rows, title, label, floor, file):
    """rows of one case; label: of the error; floor: error of the reference itself, or None."""
    figure, ax = plt.subplots(figsize=(9.5, 5.6))
    good = [r for r in rows if r.error > 0 and r.error < 1e3]  # not NaN
    for method in dict.fromkeys(r.method for r in good):
        color, marker, line = STYLES[method]
        mine = [r for r in good if r.method == method]
        front = best(mine)
        ax.loglog(
            [r.cpu for r in mine], [r.error for r in mine], marker, color=color, ms=3, alpha=0.3
        )
        x, y = [r.cpu for r in front], [r.error for r in front]
        ax.loglog(x, y, line, marker=marker, color=color, ms=6, lw=1.6, label=method)
        for r in front[:: max(1, len(front) - 1)]:
            at = (r.cpu, r.error)
            ax.annotate(r.elements, at, (4, 4), textcoords="offset points", fontsize=8, color=color)
    if floor:
        ax.axhline(floor, color="0.4", lw=0.9, ls=":")
        ax.annotate(
            "a coarser reference is off by this",
            (0.01, floor),
            (0, 3),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            fontsize=8,
            color="0.3",
        )
    ax.set_xlabel("CPU time [s]", fontsize=11)
    ax.set_ylabel(f"error of {label}", fontsize=11)
    ax.set_title(
        title + "\nbest runs of each method joined; numbers: elements or links", fontsize=11
    )
    ax.grid(alpha=0.3, which="both", lw=0.4)
    ax.legend(fontsize=9, loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    figure.savefig(file, dpi=100)
    plt.close(figure)
