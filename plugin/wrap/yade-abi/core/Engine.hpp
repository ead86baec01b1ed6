// SPDX-License-Identifier: GPL-2.0-or-later
// One item of O.engines.
#pragma once

#include <core/Omega.hpp>
#include <core/Timing.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

class Engine : public Serializable {
public:
    Scene* scene; // set before each action()
    TimingInfo timingInfo;
    shared_ptr<TimingDeltas> timingDeltas;
    bool dead;
    int ompThreads;
    string label;

    Engine();
    virtual bool isActivated();
    virtual void action();
    ANCF_PACKAGED(Engine)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Engine)
