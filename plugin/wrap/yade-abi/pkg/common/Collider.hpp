// SPDX-License-Identifier: GPL-2.0-or-later
// Finds pairs that may touch.
#pragma once

#include <core/Dispatching.hpp>
#include <core/GlobalEngine.hpp>

namespace yade {

class Collider : public GlobalEngine {
public:
    shared_ptr<BoundDispatcher> boundDispatcher;
    mask_t avoidSelfInteractionMask;

    Collider();
    // The order of declaration is that of the vtable.
    virtual vector<Body::id_t> probeBoundingVolume(const Bound&);
    virtual void invalidatePersistentData();
    void pyHandleCustomCtorArgs(py::tuple& positional, py::dict& keywords) override;
    ANCF_PACKAGED(Collider)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Collider)
