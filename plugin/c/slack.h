// Where a slack cable starts from on its way to equilibrium.
#ifndef ANCF_SLACK_H
#define ANCF_SLACK_H

#include "ancf/rest.h"

// A slack cable that is laid shorter than it is buckles in waves as short as its elements, in no direction of its own.
// So its axial stiffness is taken away until the loads are as strong as the compression, and given back step by step:
// it hangs where the loads pull it. Nothing where no element of ANCF is compressed. False: out of memory.
bool ancf_hang(ancf_model* m, ancf_rest* rest);

#endif
