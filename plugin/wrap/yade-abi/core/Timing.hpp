// SPDX-License-Identifier: GPL-2.0-or-later
// Time spent in an engine.
#pragma once

#include <lib/base/Math.hpp>

namespace yade {

struct TimingInfo {
    using delta = unsigned long long; // nanoseconds
    long nExec = 0;
    delta nsec = 0;
    static bool enabled;
};

// Parts of the time spent in an engine, for Python.
class TimingDeltas {
    TimingInfo::delta last;
    size_t i = 0;

public:
    vector<TimingInfo> data;
    vector<string> labels; // of data
};

} // namespace yade
