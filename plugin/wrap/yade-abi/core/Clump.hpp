// SPDX-License-Identifier: GPL-2.0-or-later
// Rigid group of bodies, as the shape of the body that leads them.
#pragma once

#include <core/Body.hpp>

namespace yade {

class Clump : public Shape {
public:
    using MemberMap = std::map<Body::id_t, Se3r>; // pose of each member relative to the clump
    MemberMap members;
#if ANCF_YADE_VERSION < 202502
    vector<Body::id_t> ids;
#endif

    Clump() { createIndex(); }
    void addForceTorqueFromMembers(const State* clumpState, Scene*, Vector3r& force, Vector3r& torque);
    ANCF_PACKAGED(Clump)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Clump)
