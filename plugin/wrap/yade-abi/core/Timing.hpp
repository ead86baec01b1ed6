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

class TimingDeltas;

} // namespace yade
