// SPDX-License-Identifier: GPL-2.0-or-later
// Where the time of a step goes, for O.timingEnabled; nothing is done without it.
#pragma once

#include <core/Engine.hpp>

#include <chrono>

namespace yade {

class StepClock {
    using Clock = std::chrono::steady_clock;
    TimingDeltas* times = nullptr; // of the step that goes on; null where it began without O.timingEnabled
    Clock::time_point last;

public:
    enum Part { GATHER, ELASTIC, CONTACT, SCATTER, ENERGY, PARTS };

    void start(TimingDeltas* of) {
        times = TimingInfo::enabled ? of : nullptr;
        if (!times) return;
        last = Clock::now();
        static const vector<string> names {"gather", "elastic", "contact", "scatter", "energy"};
        if (times->data.size() == PARTS) return;
        times->data.assign(PARTS, TimingInfo());
        times->labels = names;
    }
    // The time since the last call belongs to a part.
    void passed(Part part) {
        if (!times || times->data.size() != PARTS) return;
        const Clock::time_point now = Clock::now();
        TimingInfo& sum = times->data[part];
        sum.nExec += 1;
        sum.nsec += std::chrono::duration_cast<std::chrono::nanoseconds>(now - last).count();
        last = now;
    }
};

} // namespace yade
