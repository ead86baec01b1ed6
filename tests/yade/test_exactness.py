"""The short form of the exactness matrix: what is loaded goes on bit for bit, with one thread and two."""

import exactness


def test_exactness():
    table = exactness.run(length=250, saves=1, threads=(1, 2), short=True)
    assert len(table) == 2 * len(exactness.SCENES)
    assert not exactness.faults(table), exactness.faults(table)
    assert sum(row["contacts"] > 0 for row in table) >= 12


def test_a_difference_is_a_fault():
    """Unless the same happens without a cable."""
    same = {"files loaded": 8, "bit for bit": 8, "runs": 2, "as with one thread": 2, "threads": 1}
    off = {**same, "bit for bit": 7}
    cable, like = next(iter(exactness.LIKE.items()))

    def found(ours, theirs):
        return exactness.faults([{"scene": cable, **ours}, {"scene": like, **theirs}])

    assert found(off, same) and not found(off, off) and not found(same, off)
    assert exactness.faults([{"scene": "net alone", **off}, {"scene": like, **off}])
