"""The short form of the stress table: no scene is silent, late, not finite, hanging or killed."""

import pytest

import stress
from outcomes import FAULTS, each


@pytest.mark.parametrize("one", stress.ROWS, ids=lambda one: one.subject)
def test_stress(one):
    done = list(each(stress.result, stress.cases(short=True, only=one.subject), jobs=2))
    assert len(done) == min(stress.SHORT_SCENES, len(one.scenes(short=False)))
    bad = [(case[1], *told) for case, *told in done if told[0] in FAULTS]
    assert not bad, bad


def test_what_fails_is_told():
    """A scene that ends its process, one that says what is not so, and one that does not end."""

    def act(case):
        if case == "killed":
            stress.os.kill(stress.os.getpid(), 9)
        while case == "hangs":
            pass
        return stress.outcome(lambda: lost(case), lambda share: ("sound", share, ""))

    def lost(case):
        if case == "refused":
            raise ValueError("no such thing")
        return 0.0

    ends = {case: end for case, end, _, _ in each(act, ["killed", "hangs", "refused", ""], 2, 1.0)}
    assert ends == {"killed": "signal", "hangs": "hang", "refused": "refused", "": "sound"}
