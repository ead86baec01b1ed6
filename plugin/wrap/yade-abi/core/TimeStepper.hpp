// SPDX-License-Identifier: GPL-2.0-or-later
// Engine that sets the step.
#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

class TimeStepper : public GlobalEngine {
public:
    bool active;
    unsigned timeStepUpdateInterval;

    TimeStepper() : active(true), timeStepUpdateInterval(1) {}
    bool isActivated() override;
    void action() override;
    virtual void computeTimeStep(Scene*);
    ANCF_PACKAGED(TimeStepper)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(TimeStepper)
