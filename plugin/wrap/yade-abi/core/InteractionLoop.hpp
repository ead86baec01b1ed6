// SPDX-License-Identifier: GPL-2.0-or-later
// Makes contacts and applies their laws.
#pragma once

#include <core/Dispatching.hpp>
#include <core/GlobalEngine.hpp>

#include <list>

namespace yade {

class IntrCallback;

class InteractionLoop : public GlobalEngine {
    bool alreadyWarnedNoCollider;
    vector<std::list<std::pair<Body::id_t, Body::id_t>>> eraseAfterLoopIds;

public:
    shared_ptr<IGeomDispatcher> geomDispatcher;
    shared_ptr<IPhysDispatcher> physDispatcher;
    shared_ptr<LawDispatcher> lawDispatcher;
    vector<shared_ptr<IntrCallback>> callbacks;
    bool loopOnSortedInteractions;

    InteractionLoop();
    void pyHandleCustomCtorArgs(py::tuple& positional, py::dict& keywords) override;
    void action() override;
    ANCF_PACKAGED(InteractionLoop)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(InteractionLoop)
